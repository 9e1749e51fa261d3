"""The Studies page: a question asked, a study run beside the server, its answer in pictures."""
