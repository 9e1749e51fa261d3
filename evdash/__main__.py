"""`python -m evdash`."""

import sys

from evdash.cli.main import main

if __name__ == "__main__":
    sys.exit(main())
