"""The packages; ``missions/`` is installed as ``gcs.missions``. All else is in pyproject.toml."""

from setuptools import find_packages, setup

setup(
    packages=[*find_packages(include=["gcs*", "idc_controller*", "vehicle_sim*"]), "gcs.missions"],
    package_dir={"gcs.missions": "missions"},
)
