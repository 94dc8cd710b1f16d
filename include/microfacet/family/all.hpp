// The list of families: bindings, tests and documentation iterate it and name no family themselves.
#pragma once

#include <tuple>

#include "microfacet/family/beckmann.hpp"
#include "microfacet/family/bessel_k.hpp"
#include "microfacet/family/dirac.hpp"
#include "microfacet/family/double_ggx.hpp"
#include "microfacet/family/ei.hpp"
#include "microfacet/family/erfc.hpp"
#include "microfacet/family/exponential.hpp"
#include "microfacet/family/generalised_exponential.hpp"
#include "microfacet/family/ggx.hpp"
#include "microfacet/family/gtr.hpp"
#include "microfacet/family/k0.hpp"
#include "microfacet/family/student_t.hpp"

namespace microfacet {

using all_families =
    std::tuple<family_tag<beckmann>, family_tag<ggx>, family_tag<gtr>, family_tag<student_t>, family_tag<k0>,
               family_tag<bessel_k>, family_tag<ei>, family_tag<erfc>, family_tag<double_ggx>,
               family_tag<generalised_exponential>, family_tag<exponential>, family_tag<dirac>>;

}  // namespace microfacet
