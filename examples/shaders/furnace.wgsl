// Draws directions off a white metal: each invocation leaves a sample's weight, what its later orders of scattering
// multiply it by, eval/pdf of the same pair, and the cosine of its direction.
@metal@

struct Asked { alpha: f32, shape: f32, count: u32, cosines: u32 }

@group(0) @binding(0) var<uniform> asked: Asked;
@group(0) @binding(1) var energy: texture_2d<f32>;
@group(0) @binding(2) var state: sampler;
@group(0) @binding(3) var<storage, read_write> found: array<vec4f>;

// Uniform numbers in [0, 1), of 24 bits (Jarzynski and Olano, Hash functions for GPU rendering, 2020).
fn uniforms(seed: vec4u) -> vec4f {
  var v = seed * 1664525u + 1013904223u;
  v += v.yzxy * v.wxyz;
  v ^= v >> vec4u(16u);
  v += v.yzxy * v.wxyz;
  return vec4f(v >> vec4u(8u)) / 16777216.0;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
  let i = id.x;
  if (i >= asked.count * asked.cosines) { return; }
  let cosine = (f32(i / asked.count) + 0.5) / f32(asked.cosines);
  let wi = vec3f(sqrt(1.0 - cosine * cosine), 0.0, cosine);
  let eta = vec3f(1.0);
  let k = vec3f(1e4);  // reflects all
  let drawn = metal_sample(wi, uniforms(vec4u(i, 1u, 2u, 3u)), asked.alpha, asked.shape, eta, k);
  let more = metal_energy(wi, asked.alpha, asked.shape, eta, k, energy, state);
  let f = metal_eval(wi, drawn.wo, asked.alpha, asked.shape, eta, k);
  let pdf = metal_pdf(wi, drawn.wo, asked.alpha, asked.shape, eta, k);
  found[i] = vec4f(drawn.weight.x, more.x, select(0.0, f.x / pdf, pdf > 0.0), drawn.wo.z);
}
