"""Runs kept on disk, so that a link brings one back as it was, without solving anything again."""
