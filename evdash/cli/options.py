"""Options that several commands have in common."""

import argparse


def add_settings(command: argparse._ActionsContainer, told: str) -> None:
    """Put `--set` on a command: keys of scenario.toml, in `settings`."""
    command.add_argument(
        "--set", action="append", default=[], dest="settings", metavar="KEY=VALUE", help=told
    )
