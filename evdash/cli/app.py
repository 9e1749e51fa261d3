"""`app`: the app in the browser, from wherever evdash is installed."""

import argparse
import runpy
import sys

from evdash.resources import APP

MOST_PORT = 65_535


def add_app(commands: "argparse._SubParsersAction[argparse.ArgumentParser]", statuses: str) -> None:
    """The command and its options."""
    command = commands.add_parser(
        "app",
        help="open the app in the browser",
        description="Serve the app on this machine only, and open it in the browser, until "
        "interrupted. docs/deploy.md opens it to others.",
        epilog=statuses,
    )
    command.add_argument("--port", type=_port, metavar="N", help="where it listens (default: 8501)")
    command.add_argument(
        "--headless", action="store_true", help="do not open a browser, as on a server"
    )
    command.add_argument(
        "streamlit",
        nargs="*",
        metavar="OPTION",
        help="after `--`: further options of `streamlit run`, such as --server.baseUrlPath=evdash",
    )
    command.set_defaults(command=serve)


def _port(text: str) -> int:
    port = int(text)
    if not 1 <= port <= MOST_PORT:
        raise argparse.ArgumentTypeError(f"should be from 1 to {MOST_PORT}")
    return port


def serve(options: argparse.Namespace) -> int:
    """Become Streamlit's server, with the settings that lie beside the app's file."""
    told = [] if options.port is None else [f"--server.port={options.port}"]
    told += ["--server.headless=true"] if options.headless else []
    sys.argv = ["streamlit", "run", str(APP), *told, *options.streamlit]
    runpy.run_module("streamlit", run_name="__main__", alter_sys=True)
    return 0
