"""``python -m gcs``."""

import sys

from gcs.app.cli import main

sys.exit(main())
