"""`python -m fapstream`."""

from fapstream.cli import main

raise SystemExit(main())
