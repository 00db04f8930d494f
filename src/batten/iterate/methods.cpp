#include <batten/iterate/methods.hpp>

#include <batten/core/names.hpp>
#include <batten/iterate/accelerated.hpp>
#include <batten/iterate/conjugate_gradients.hpp>
#include <batten/iterate/lspia.hpp>
#include <batten/iterate/mlspia.hpp>

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace batten {

namespace {

constexpr MethodSetting eigenvalue_setting{
    "eigenvalue_tolerance", "relative accuracy of the extreme eigenvalues (default 1e-2)"};

const std::vector<MethodEntry>& table() {
    static const std::vector<MethodEntry> all = {
        {"auto", "the fastest that answers the question", "", {}},
        {"search", "the fewest control points within a tolerance", "", {}},
        {"direct", "banded Cholesky of the normal equations, axis by axis", "", {}},
        {"lspia",
         "least-squares PIA",
         "Deng, Lin 2014",
         {{"mu", "step factor (default 2 / (sigma_1^2 + sigma_r^2))"}, eigenvalue_setting}},
        {"mlspia",
         "least-squares PIA with memory",
         "Huang, Wang 2020",
         {{"omega", "weight omega (default eq. 27, 37)"},
          {"gamma", "weight gamma (default eq. 27, 37)"},
          {"nu", "weight nu (default eq. 27, 37)"},
          eigenvalue_setting}},
        {"clspia",
         "LSPIA with Lagrange multipliers: exact at the interpolated samples",
         "Chang, Ma, Deng 2023",
         {{"mu", "outer step (default 2 / (beta_min + beta_max))"},
          {"mu_1", "inverse inner step (default (gamma_min + gamma_max) / 2)"},
          {"inner_tolerance", "max |Delta| that ends the inner loop (default: a hundredth of the "
                              "constraint error at hand)"},
          eigenvalue_setting}},
        {"pia",
         "progressive-iterative approximation: interpolates every sample",
         "Lin, Wang, Dong 2004",
         {{"weight", "factor of every move (default 1)"}}},
        {"epia",
         "PIA with groups of samples, knots added where the error is",
         "Lin, Zhang 2011",
         {{"eta", "validation threshold, eq. 47 (default 0.6)"},
          {"t_c", "e_c below which a knot is inserted (default 0.9 of the stop deviation, else "
                  "2.5e-3 of the data's size)"},
          {"rounds", "most rounds of the validation check (default 2)"},
          {"smoothing", "widest Gaussian of the curvature, in samples (default 4)"},
          {"exact", "1: keep the refined knots instead of regenerating them by eq. 38"}}},
        {"cg",
         "conjugate gradients, preconditioned axis by axis on clouds, by the diagonal elsewhere",
         "Hestenes, Stiefel 1952",
         {{"plain", "1: without the preconditioner"},
          {"diagonal", "1: by the diagonal on clouds, too"}}},
        {"chebyshev", "LSPIA with Chebyshev steps", "Golub, Varga 1961", {eigenvalue_setting}},
        {"nesterov", "LSPIA with Nesterov's momentum", "Nesterov 2004", {eigenvalue_setting}},
        {"barzilai-borwein",
         "LSPIA with Barzilai-Borwein steps and a non-monotone search",
         "Barzilai, Borwein 1988; Grippo, Lampariello, Lucidi 1986",
         {{"memory", "energies that the search looks back on (default 10)"}}},
    };
    return all;
}

} // namespace

double setting(const Settings& settings, const std::string& name, double otherwise) {
    const auto found = settings.find(name);
    return found == settings.end() ? otherwise : found->second;
}

std::span<const MethodEntry> methods() {
    return table();
}

const MethodEntry& method_entry(std::string_view name) {
    std::vector<std::string_view> names;
    for (const MethodEntry& entry : table()) {
        if (entry.name == name) return entry;
        names.push_back(entry.name);
    }
    throw InvalidInput(unknown_name("method", name, names));
}

void check_settings(const MethodEntry& entry, const Settings& settings) {
    std::vector<std::string_view> names;
    for (const MethodSetting& s : entry.settings) names.push_back(s.name);
    for (const auto& [name, value] : settings) {
        if (names.empty())
            throw InvalidInput(
                fmt::format("method {} has no settings, got '{}'", entry.name, name));
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw InvalidInput(
                unknown_name(fmt::format("setting of method {}", entry.name), name, names));
        if (!std::isfinite(value))
            throw InvalidInput(fmt::format("setting {} = {} must be finite", name, value));
    }
}

std::unique_ptr<Method> make_method(std::string_view name, const NormalSystem& system,
                                    const Settings& settings) {
    check_settings(method_entry(name), settings);
    const double accuracy = setting(settings, "eigenvalue_tolerance", 1e-2);
    if (name == "lspia")
        return std::make_unique<Lspia>(system, setting(settings, "mu", 0), accuracy);
    if (name == "mlspia") {
        const MlspiaWeights weights{setting(settings, "omega", 0), setting(settings, "gamma", 0),
                                    setting(settings, "nu", 0)};
        return std::make_unique<Mlspia>(system, weights, accuracy);
    }
    if (name == "cg") {
        const bool plain = setting(settings, "plain", 0) != 0;
        const bool diagonal = setting(settings, "diagonal", 0) != 0;
        return std::make_unique<ConjugateGradients>(system, plain      ? Preconditioner::none
                                                            : diagonal ? Preconditioner::diagonal
                                                                       : Preconditioner::axes);
    }
    if (name == "chebyshev") return std::make_unique<Chebyshev>(system, accuracy);
    if (name == "nesterov") return std::make_unique<Nesterov>(system, accuracy);
    if (name == "barzilai-borwein")
        return std::make_unique<BarzilaiBorwein>(
            system, static_cast<int>(std::max(1.0, setting(settings, "memory", 10))));
    throw InvalidInput(fmt::format("method {} is no iteration on the normal equations", name));
}

} // namespace batten
