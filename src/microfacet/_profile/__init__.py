"""Profiles: heights along a line, as stylus instruments measure them.

`traces` holds the data and `profile` what is done to them, with `form` (lines, polynomials, circles);
`parameters` and `spectrum` describe the result. `reading` turns files into profiles.
"""

from __future__ import annotations

from microfacet._profile.parameters import ProfileRoughness
from microfacet._profile.profile import Profile
from microfacet._profile.reading import holds_profile, of_instrument, read_profile
from microfacet._profile.spectrum import ProfileSpectrum

__all__ = ["Profile", "ProfileRoughness", "ProfileSpectrum", "holds_profile", "of_instrument", "read_profile"]
