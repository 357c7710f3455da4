"""``python -m stickslip``: the command line, where its script is not on the path."""

from stickslip.cli.main import main

if __name__ == "__main__":
    main()
