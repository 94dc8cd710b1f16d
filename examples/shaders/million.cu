// Evaluates a metal at a million samples of its own: nvcc -O2 million.cu -o million && ./million [energy.raw WIDTH HEIGHT]
#include <cstdio>
#include <cstdlib>
#include <vector>

#include <cuda_runtime.h>

#include "metal.cuh"

namespace {

constexpr unsigned count = 1u << 20, cosines = 8;

void check(cudaError_t status) {
  if (status == cudaSuccess) return;
  std::fprintf(stderr, "CUDA: %s\n", cudaGetErrorString(status));
  std::exit(1);
}

// Uniform numbers in [0, 1), of 24 bits (Jarzynski and Olano, Hash functions for GPU rendering, 2020).
__device__ float4 uniforms(uint4 v) {
  v = make_uint4(v.x * 1664525u + 1013904223u, v.y * 1664525u + 1013904223u, v.z * 1664525u + 1013904223u,
                 v.w * 1664525u + 1013904223u);
  v.x += v.y * v.w, v.y += v.z * v.x, v.z += v.x * v.y, v.w += v.y * v.z;
  v.x ^= v.x >> 16, v.y ^= v.y >> 16, v.z ^= v.z >> 16, v.w ^= v.w >> 16;
  v.x += v.y * v.w, v.y += v.z * v.x, v.z += v.x * v.y, v.w += v.y * v.z;
  constexpr float scale = 1.0f / 16777216.0f;
  return make_float4(scale * static_cast<float>(v.x >> 8), scale * static_cast<float>(v.y >> 8),
                     scale * static_cast<float>(v.z >> 8), scale * static_cast<float>(v.w >> 8));
}

// A sample's weight, what later orders of scattering multiply it by, and eval/pdf of the same pair.
__global__ void draw(float alpha, float shape, cudaTextureObject_t energy, float3* found) {
  const unsigned i = blockIdx.x * blockDim.x + threadIdx.x;
  const float cosine = (static_cast<float>(i / (count / cosines)) + 0.5f) / static_cast<float>(cosines);
  const float3 wi = make_float3(sqrtf(1.0f - cosine * cosine), 0.0f, cosine);
  const float3 eta = make_float3(1.0f, 1.0f, 1.0f), k = make_float3(1e4f, 1e4f, 1e4f);  // reflects all
  const metal_sampled drawn = metal_sample(wi, uniforms(make_uint4(i, 1, 2, 3)), alpha, shape, eta, k);
  const float pdf = metal_pdf(wi, drawn.wo, alpha, shape, eta, k);
  const float f = metal_eval(wi, drawn.wo, alpha, shape, eta, k).x;
  const float more = energy ? metal_energy(wi, alpha, shape, eta, k, energy).x : 1.0f;
  found[i] = make_float3(drawn.weight.x, more, pdf > 0.0f ? f / pdf : 0.0f);
}

// Pairs of numbers from energy.raw.
cudaTextureObject_t texture_of(const char* path, std::size_t width, std::size_t height) {
  std::vector<float2> texels(width * height);
  std::FILE* file = std::fopen(path, "rb");
  if (!file || std::fread(texels.data(), sizeof(float2), texels.size(), file) != texels.size()) {
    std::fprintf(stderr, "%s does not hold %zu x %zu texels\n", path, width, height);
    std::exit(1);
  }
  std::fclose(file);
  cudaArray_t array;
  const cudaChannelFormatDesc format = cudaCreateChannelDesc<float2>();
  check(cudaMallocArray(&array, &format, width, height));
  check(cudaMemcpy2DToArray(array, 0, 0, texels.data(), 8 * width, 8 * width, height, cudaMemcpyHostToDevice));
  cudaResourceDesc resource = {};
  resource.resType = cudaResourceTypeArray;
  resource.res.array.array = array;
  cudaTextureDesc read = {};
  read.addressMode[0] = read.addressMode[1] = cudaAddressModeClamp;
  read.filterMode = cudaFilterModeLinear;
  read.normalizedCoords = 1;
  cudaTextureObject_t texture;
  check(cudaCreateTextureObject(&texture, &resource, &read, nullptr));
  return texture;
}

}  // namespace

int main(int arguments, char** words) {
  int devices = 0;
  if (cudaGetDeviceCount(&devices) != cudaSuccess || devices == 0) {
    std::puts("there is no CUDA device here");
    return 0;
  }
  const auto number = [&](int i) { return static_cast<std::size_t>(std::atoi(words[i])); };
  const cudaTextureObject_t energy = arguments > 3 ? texture_of(words[1], number(2), number(3)) : 0;
  float3* on_device;
  std::vector<float3> found(count);
  check(cudaMalloc(&on_device, count * sizeof(float3)));
  draw<<<count / 256, 256>>>(0.5f, 2.5f, energy, on_device);
  check(cudaGetLastError());
  check(cudaMemcpy(found.data(), on_device, count * sizeof(float3), cudaMemcpyDeviceToHost));
  std::puts("cosine  one order  all orders  eval/pdf");
  for (unsigned i = 0; i < cosines; ++i) {
    double one = 0, all = 0, ratio = 0;
    for (unsigned j = i * (count / cosines); j < (i + 1) * (count / cosines); ++j) {
      one += found[j].x, all += found[j].x * found[j].y, ratio += found[j].z;
    }
    const double each = count / cosines;
    std::printf("%.4f %10.4f %11.4f %9.4f\n", (i + 0.5) / cosines, one / each, all / each, ratio / each);
  }
  return 0;
}
