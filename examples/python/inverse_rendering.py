"""How rough is it? Alpha and gamma of a Student-T metal, recovered from one picture of a sphere.

python examples/python/inverse_rendering.py

Needs Mitsuba (pip install ".[mitsuba]" in a checkout). The picture is rendered with parameters that the
search does not see. It starts elsewhere and follows derivatives of its own pictures by both parameters.
"""

import drjit as dr
import mitsuba as mi

mi.set_variant("llvm_ad_rgb")
import microfacet.mitsuba  # noqa: E402, F401  (registers the plugins)

TRUE = {"alpha": 0.2, "gamma": 2.2}
START = {"alpha": 0.5, "gamma": 5.0}
STEPS = 120

scene = mi.load_dict(
    {
        "type": "scene",
        "integrator": {"type": "prb", "max_depth": 2},
        "sensor": {
            "type": "perspective",
            "fov": 30,
            "to_world": mi.ScalarTransform4f().look_at([0, -4, 0.5], [0, 0, 0], [0, 0, 1]),
            "film": {"type": "hdrfilm", "width": 64, "height": 64, "pixel_format": "luminance"},
        },
        "lamp": {
            "type": "sphere",
            "center": [-2, -3, 4],
            "radius": 0.7,
            "emitter": {"type": "area", "radiance": {"type": "rgb", "value": 30.0}},
        },
        "ball": {
            "type": "sphere",
            "bsdf": {"type": "microfacet_conductor", "distribution": "student_t", "material": "Ag", **TRUE},
        },
    }
)
photograph = mi.render(scene, spp=1024)

parameters = mi.traverse(scene)
names = {"alpha": "ball.bsdf.alpha.value", "gamma": "ball.bsdf.gamma"}
optimizer = mi.ad.Adam(lr=0.1)
# Logarithms: a step is a share of the value, and alpha stays positive. Gamma has to exceed 3/2.
optimizer["alpha"] = mi.Float(dr.log(START["alpha"]))
optimizer["gamma"] = mi.Float(dr.log(START["gamma"] - 1.5))


def compress(picture):
    """Dark pixels, where the tails are, count as much as the highlight."""
    return dr.log(picture.array + 1e-3)


tail = []  # the last steps, which scatter about the result
for step in range(STEPS):
    parameters[names["alpha"]] = dr.exp(optimizer["alpha"])
    parameters[names["gamma"]] = 1.5 + dr.exp(optimizer["gamma"])
    parameters.update()
    picture = mi.render(scene, parameters, spp=32, seed=step)
    loss = dr.mean(dr.square(compress(picture) - compress(photograph)))
    dr.backward(loss)
    optimizer.step()
    alpha, gamma = parameters[names["alpha"]][0], parameters[names["gamma"]][0]
    if step >= STEPS - 20:
        tail.append((alpha, gamma))
    if step % 20 == 0 or step == STEPS - 1:
        print(f"step {step:3}: alpha {alpha:.3f}, gamma {gamma:.2f}, loss {loss[0]:.4f}")
    optimizer.set_learning_rate(0.1 if step < STEPS // 2 else 0.02)  # first far, then exactly

alpha, gamma = (sum(values) / len(tail) for values in zip(*tail, strict=True))
print(f"recovered: alpha {alpha:.3f}, gamma {gamma:.2f}")
print(f"true:      alpha {TRUE['alpha']:.3f}, gamma {TRUE['gamma']:.2f}")
