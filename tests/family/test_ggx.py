"""What only GGX has: it is the distribution of normals of an ellipsoid."""

import numpy as np
from numpy.testing import assert_allclose

import microfacet as mf


def test_sigma_is_the_shadow_of_a_half_ellipsoid() -> None:
    """Half the shadow of the ellipsoid, plus half that of the disc that closes it."""
    u = np.linspace(-0.999, 1, 60)[:, None]
    alpha = np.array([0.01, 0.3, 1.0, 4.0])
    shadow = np.sqrt(u * u + alpha**2 * (1 - u) * (1 + u))
    expected = np.where(u >= 0, (u + shadow) / 2, alpha**2 * (1 - u * u) / 2 / (shadow + np.abs(u)))
    assert_allclose(mf.ggx.sigma(u, alpha), expected, rtol=1e-13)


def test_anisotropic_density_is_that_of_an_ellipsoid() -> None:
    """D(m) = 1/(pi alpha_x alpha_y ((m_x/alpha_x)^2 + (m_y/alpha_y)^2 + m_z^2)^2)."""
    rng = np.random.default_rng(2)
    m = rng.normal(size=(100, 3))
    m /= np.linalg.norm(m, axis=-1, keepdims=True)
    m[:, 2] = np.abs(m[:, 2])
    stretched = m / [0.2, 0.7, 1.0]
    expected = 1 / (np.pi * 0.2 * 0.7 * np.sum(stretched**2, axis=-1) ** 2)
    assert_allclose(mf.GGX(alpha_x=0.2, alpha_y=0.7).D(m), expected, rtol=1e-13)


def test_uniform_normals_at_alpha_1() -> None:
    u = np.linspace(1e-3, 1, 20)
    assert_allclose(mf.ggx.D(u, 1.0), 1 / np.pi, rtol=1e-15)
    assert_allclose(mf.ggx.sigma(-u, 1.0), (1 - u) / 2, rtol=1e-13)
