"""``python -m vehicle_sim``: the command ``vehicle-sim``."""

import sys

from vehicle_sim.app.cli import main

if __name__ == "__main__":
    sys.exit(main())
