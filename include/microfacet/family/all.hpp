// The list of families: bindings, tests and documentation iterate it and name no family themselves.
#pragma once

#include <tuple>

#include "microfacet/family/beckmann.hpp"
#include "microfacet/family/bessel_k.hpp"
#include "microfacet/family/ggx.hpp"
#include "microfacet/family/gtr.hpp"
#include "microfacet/family/k0.hpp"
#include "microfacet/family/student_t.hpp"

namespace microfacet {

using all_families = std::tuple<family_tag<beckmann>, family_tag<ggx>, family_tag<gtr>, family_tag<student_t>,
                                family_tag<k0>, family_tag<bessel_k>>;

}  // namespace microfacet
