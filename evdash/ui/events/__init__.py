"""Something happens: choose it, read what it would do, let it happen, read the ledger."""
