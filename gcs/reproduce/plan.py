"""The simulations and flights of ``gcs reproduce``, quick and in full."""

from dataclasses import dataclass, replace

from gcs.reproduce.controls import PaperVariant
from gcs.reproduce.simulation import EXTRAPOLATING, PROJECT, Case

PRINTED = PaperVariant("states")
"""The reading of the paper whose simulation does not diverge."""
MASSES = (2.7, 3.0, 3.3)
"""kg, of the plant's payload."""
DESIGN_MASS = 3.0
"""kg, of the controller's payload in the mass study."""
POLES = ((1.0, 1.0), (4.0, 4.0), (1.0, 4.0))
"""1/s, in addition to (2, 2): the paper gives none."""


@dataclass(frozen=True)
class Plan:
    """Cases by section and name; mission file and controller of each flight by name; frames of an animation."""

    quick: bool
    cases: dict[tuple[str, str], Case]
    flights: dict[str, tuple[str, str]]
    frames: int


def plan(quick: bool) -> Plan:
    """Return the full plan, or the quick one: without flights in PyBullet, repeats of the noise, and slow variants."""
    as_printed, shaped = (12.0, 8.0) if quick else (40.0, 40.0)
    base = {
        "outputs": Case(PaperVariant("outputs"), as_printed),
        "printed": Case(PRINTED, as_printed),
        "corrected": Case(PaperVariant("flat"), shaped),
        "project": Case(PROJECT, shaped),
    }
    cases = {("tracking", name): case for name, case in base.items()}
    avoiding = {name: replace(case, obstacles=True) for name, case in base.items() if name != "outputs"}
    avoiding["extrapolating"] = replace(avoiding["project"], control=EXTRAPOLATING)
    if not quick:
        avoiding["nonlinear"] = replace(avoiding["printed"], control=replace(PRINTED, acceleration="nonlinear"))
        for poles in POLES:
            name = f"poles_{poles[0]:g}_{poles[1]:g}"
            avoiding[name] = replace(avoiding["printed"], control=replace(PRINTED, poles=poles))
    cases |= {("avoidance", name): case for name, case in avoiding.items()}
    compared = ("printed",) if quick else ("printed", "project")
    for name in compared:
        short = replace(avoiding[name], duration=12.0 if name == "printed" else 16.0)
        for mass in MASSES:
            cases["mass", f"{name}_{mass:g}"] = replace(short, design_mass=DESIGN_MASS, plant_mass=mass)
        for margin in (0.25, 1.0) if quick else (0.25, 0.5, 0.75, 1.0, 1.5):
            cases["margin", f"{name}_{margin:g}"] = replace(short, margin=margin)
        for sigma in (0.008, 0.05) if quick else (0.002, 0.004, 0.008, 0.012, 0.02, 0.03, 0.05):
            for seed in (1,) if quick else (1, 2, 3):
                cases["noise", f"{name}_{sigma:g}_{seed}"] = replace(short, sigma=sigma, seed=seed)
    flights = {
        f"{mission}_{controller}": (f"{mission}.toml", controller)
        for mission in ("pole_course", "figure_eight_spheres")
        for controller in ("idc", "paper")
    }
    return Plan(quick, cases, {} if quick else flights, 16 if quick else 120)
