"""Options that several commands have in common."""

import argparse

SCENARIO = (
    "a scenario folder or a .zip of one, or the name of a bundled one, such as price-spike; "
    "without it the bundled IEEE 13-node day"
)


def add_settings(command: argparse._ActionsContainer, told: str) -> None:
    """Put `--set` on a command: keys of scenario.toml, in `settings`."""
    command.add_argument(
        "--set", action="append", default=[], dest="settings", metavar="KEY=VALUE", help=told
    )
