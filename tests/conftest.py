"""Settings of all tests."""

from hypothesis import HealthCheck, settings

# The same examples on every run and machine, and no deadline: a test never fails on time.
settings.register_profile(
    "ci",
    derandomize=True,
    deadline=None,
    max_examples=40,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
# More examples, and new ones each time: `pytest --hypothesis-profile=long`.
settings.register_profile("long", deadline=None, max_examples=1000)
settings.load_profile("ci")
