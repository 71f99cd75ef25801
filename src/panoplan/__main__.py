"""`python -m panoplan`."""

import sys

from panoplan.cli.main import main

sys.exit(main())
