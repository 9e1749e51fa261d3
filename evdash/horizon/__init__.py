"""The moving horizon: arrivals, requests, one loop over the day, changes in mid-day."""
