"""A white metal in a white furnace, in WGSL on whatever Vulkan driver there is: how much light returns?

    python examples/shaders/furnace.py shaders/student_t [--slang] [--alpha 0.5] [--shape 2.5]

The folder is one that make.py made. With --slang, slangc prints the WGSL, of furnace.slang. Needs the package
wgpu.
"""

from __future__ import annotations

import json
import shutil
import subprocess
import tempfile
from pathlib import Path

import click
import numpy as np
import wgpu

import microfacet as mf

COUNT, COSINES = 1 << 14, 8


def wgsl_of(folder: Path, slang: str | None) -> tuple[str, str]:
    """The program and its entry point."""
    if slang is None:
        text = (folder / "furnace.wgsl").read_text("utf-8")
        return text.replace("@metal@", (folder / "metal.wgsl").read_text("utf-8")), "main"
    with tempfile.TemporaryDirectory() as temporary:
        printed = Path(temporary) / "furnace.wgsl"
        words = [slang, folder / "furnace.slang", "-entry", "run", "-stage", "compute", "-target", "wgsl"]
        subprocess.run([*map(str, words), "-o", str(printed)], check=True)
        return printed.read_text("utf-8"), "run"


def furnace(folder: Path, alpha: float, shape: float, slang: str | None = None) -> np.ndarray:
    """What furnace.wgsl leaves, by cosine and sample."""
    code, entry = wgsl_of(folder, slang)
    device = wgpu.gpu.request_adapter_sync().request_device_sync(required_features=["float32-filterable"])
    values = np.fromfile(folder / "energy.raw", np.float32)
    says = json.loads((folder / "energy.raw.json").read_text("utf-8"))
    size = (says["width"], says["height"] * says["slices"], 1)
    usage = wgpu.TextureUsage
    image = device.create_texture(
        size=size, format=wgpu.TextureFormat.rg32float, usage=usage.COPY_DST | usage.TEXTURE_BINDING
    )
    layout = {"offset": 0, "bytes_per_row": 8 * size[0], "rows_per_image": size[1]}
    device.queue.write_texture({"texture": image}, values, layout, size)
    state = device.create_sampler(mag_filter="linear", min_filter="linear")  # and clamped to the edge
    number = np.array([(alpha, shape, COUNT, COSINES)], "f4, f4, u4, u4")
    asked = device.create_buffer_with_data(data=number, usage=wgpu.BufferUsage.UNIFORM)
    usages = wgpu.BufferUsage.STORAGE | wgpu.BufferUsage.COPY_SRC
    found = device.create_buffer(size=16 * COUNT * COSINES, usage=usages)
    module = device.create_shader_module(code=code)
    pipeline = device.create_compute_pipeline(layout="auto", compute={"module": module, "entry_point": entry})
    resources = [{"buffer": asked}, image.create_view(), state, {"buffer": found}]
    group = device.create_bind_group(
        layout=pipeline.get_bind_group_layout(0),
        entries=[{"binding": i, "resource": resource} for i, resource in enumerate(resources)],
    )
    encoder = device.create_command_encoder()
    work = encoder.begin_compute_pass()
    work.set_pipeline(pipeline)
    work.set_bind_group(0, group)
    work.dispatch_workgroups(COUNT * COSINES // 64)
    work.end()
    device.queue.submit([encoder.finish()])
    return np.frombuffer(device.queue.read_buffer(found), np.float32).reshape(COSINES, COUNT, 4)


@click.command(help=(__doc__ or "").split("\n")[0])
@click.argument("folder", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option("--slang", is_flag=True, help="Let slangc print the program.")
@click.option("--alpha", default=0.5, show_default=True)
@click.option("--shape", default=2.5, show_default=True, help="Where the family has one that is free.")
def main(folder: Path, slang: bool, alpha: float, shape: float) -> None:
    """Print a line a cosine."""
    compiler = (shutil.which("slangc") or "slangc") if slang else None
    found = furnace(folder, alpha, shape, compiler)
    says = json.loads((folder / "energy.raw.json").read_text("utf-8"))
    family = next(family for family in mf.families() if family.name == says["family"])
    own = [parameter.name for parameter in family.parameters[1:]]
    given = {axis["quantity"]: axis["values"] for axis in says["axes"]}
    shapes = {name: given[name][0] if len(given[name]) == 1 else shape for name in own}
    metal = mf.Conductor(family.cls(alpha=alpha, **shapes))
    print("cosine  one order  the library's  all orders")
    for i, part in enumerate(found.astype(float)):
        cosine = (i + 0.5) / COSINES
        wi = [np.sqrt(1 - cosine**2), 0.0, cosine]
        one, every = part[:, 0].mean(), (part[:, 0] * part[:, 1]).mean()
        print(f"{cosine:.4f} {one:10.4f} {metal.albedo(wi):14.4f} {every:11.4f}")
    ratio = found[..., 2] / np.where(found[..., 0] > 0, found[..., 0], 1)
    print(f"Largest difference of eval/pdf and weight: {np.abs(ratio[found[..., 0] > 0] - 1).max():.1e}")


if __name__ == "__main__":
    main()
