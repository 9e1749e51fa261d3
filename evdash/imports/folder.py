"""The scenario folder an import goes into: begun anew or changed, whole or not at all."""

from pathlib import Path

from evdash.errors import Fault, InputError
from evdash.files.draft import Draft, files_of, read_draft, scenario_of
from evdash.files.exchange import claimed
from evdash.files.folder import read_files
from evdash.files.overrides import Setting, apply_settings
from evdash.files.scenario_folder import FILE_NAMES, SETTINGS

RULE = "should be a scenario folder, an empty one, or a new name"


def draft_in(folder: Path, base: Path) -> Draft:
    """The scenario in `folder`, or the one to begin from where there is none yet."""
    if not folder.exists():
        return read_draft(read_files(base))
    if not folder.is_dir():
        raise InputError([Fault(str(folder), "something that is not a folder", RULE)])
    if not (folder / SETTINGS).is_file():
        if any(folder.iterdir()):
            raise InputError([Fault(str(folder), f"a folder without {SETTINGS}", RULE)])
        return read_draft(read_files(base))
    return read_draft(read_files(folder))


def with_overrides(draft: Draft, settings: tuple[Setting, ...]) -> Draft:
    """The draft with single keys laid over; InputError names unknown ones."""
    raw, faults = apply_settings(draft.settings, settings)
    if faults:
        raise InputError(faults)
    return draft.with_settings(raw)


def write_draft(folder: Path, draft: Draft) -> None:
    """Write a draft that is a valid scenario; nothing is written if it is not (InputError).

    Its files change together; tables nothing refers to any more are taken out.
    """
    scenario_of(draft)
    with claimed(folder, str(folder)) as claim:
        claim.replace(files_of(draft), own=FILE_NAMES, last=SETTINGS)
