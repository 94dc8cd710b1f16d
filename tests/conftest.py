"""Settings for all tests: property tests are the same in every run."""

from hypothesis import settings

settings.register_profile("microfacet", deadline=None, derandomize=True, database=None)
settings.load_profile("microfacet")
