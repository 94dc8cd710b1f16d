// What a graph is recorded for: a quantity, its parameters, and numbers of them on the graph that records.
#pragma once

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "microfacet/core/vec.hpp"
#include "microfacet/record/control.hpp"

namespace microfacet::record {

// Parameters by name; one without a value is an input. So are the components of directions.
struct request {
  std::string quantity;
  std::map<std::string, std::optional<double>> parameters;
  std::vector<std::string> derivatives{};  // inputs by which the results are differentiated
  bool of_cosine = false;                  // D, sigma, Lambda and G1 of u = cos(theta)
  bool mixture = false;                    // materials draw normals by the mixture scheme
  bool retroreflective = false;            // mirrors send light back: wi turned about the normal
  int channels = 1;                        // of reflectances

  bool has(const std::string& name) const { return parameters.contains(name); }
};

// Numbers for one request on the graph that records, and its results.
template <class Real>
class recorder {
 public:
  using T = number<Real>;
  explicit recorder(const request& r) : request_(r) {}

  const request& asked() const { return request_; }
  T input(const std::string& name) const {
    const auto place = std::find(request_.derivatives.begin(), request_.derivatives.end(), name);
    const int id = here().input(name);
    if (place == request_.derivatives.end()) return T::of(id);
    return T::varying(id, static_cast<std::size_t>(place - request_.derivatives.begin()));
  }
  T parameter(const std::string& name) const {
    const auto place = request_.parameters.find(name);
    if (place == request_.parameters.end()) throw std::invalid_argument("parameter " + name + " is missing");
    return place->second ? T(*place->second) : input(name);
  }
  vec3<T> direction(const std::string& name) const {
    return {input(name + ".x"), input(name + ".y"), input(name + ".z")};
  }
  void give(const std::string& name, const T& value) const {
    here().results.emplace_back(name, value.id());
    for (std::size_t k = 0; k < request_.derivatives.size(); ++k)
      here().results.emplace_back(name + "/" + request_.derivatives[k], value.derivative(k).id());
  }
  void give(const std::string& name, const vec3<T>& w) const {
    give(name + ".x", w.x), give(name + ".y", w.y), give(name + ".z", w.z);
  }

 private:
  const request& request_;
};

}  // namespace microfacet::record
