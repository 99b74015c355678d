"""Settings shared by all tests: hypothesis draws the same examples on every run."""

from hypothesis import HealthCheck, settings

settings.register_profile(
    "repeatable",
    derandomize=True,
    database=None,
    deadline=None,  # the first example compiles kernels
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("repeatable")
