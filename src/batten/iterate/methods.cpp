#include <batten/iterate/methods.hpp>

#include <batten/core/names.hpp>
#include <batten/iterate/accelerated.hpp>
#include <batten/iterate/alspia.hpp>
#include <batten/iterate/anderson.hpp>
#include <batten/iterate/conjugate_gradients.hpp>
#include <batten/iterate/fairing_pia.hpp>
#include <batten/iterate/lin2018.hpp>
#include <batten/iterate/lspia.hpp>
#include <batten/iterate/method_settings.hpp>
#include <batten/iterate/mlspia.hpp>
#include <batten/iterate/monotone_lspia.hpp>
#include <batten/iterate/plspia.hpp>
#include <batten/iterate/rpia.hpp>
#include <batten/iterate/salspia.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace batten {

namespace {

using namespace method_settings;

constexpr MethodEntry table[]{
    {"auto", "the fastest that answers the question", "", {}},
    {"search", "the fewest control points within a tolerance", "", {}},
    {"direct", "banded Cholesky of the normal equations, axis by axis", "", {}},
    {"lspia", "least-squares PIA", "Deng, Lin 2014", lspia_settings},
    {"mlspia", "least-squares PIA with memory", "Huang, Wang 2020", mlspia_settings},
    {"clspia", "LSPIA with Lagrange multipliers: exact at the interpolated samples",
     "Chang, Ma, Deng 2023", clspia_settings},
    {"pia", "progressive-iterative approximation: interpolates every sample",
     "Lin, Wang, Dong 2004", pia_settings},
    {"epia", "PIA with groups of samples, knots added where the error is", "Lin, Zhang 2011",
     epia_settings},
    {"cg", "conjugate gradients, preconditioned axis by axis on clouds, by the diagonal elsewhere",
     "Hestenes, Stiefel 1952", cg_settings},
    {"chebyshev", "LSPIA with Chebyshev steps", "Golub, Varga 1961", eigenvalues_only},
    {"nesterov", "LSPIA with Nesterov's momentum", "Nesterov 2004", eigenvalues_only},
    {"barzilai-borwein", "LSPIA with Barzilai-Borwein steps and a non-monotone search",
     "Barzilai, Borwein 1988; Grippo, Lampariello, Lucidi 1986", barzilai_borwein_settings},
    {"salspia", "LSPIA with steps that adapt to the spectrum, without eigenvalues", "Peng, Li 2026",
     salspia_settings},
    {"alspia", "LSPIA with one over Chebyshev roots as steps", "Wu, Liu 2024", alspia_settings},
    {"nmlspia", "LSPIA with Nesterov's momentum", "Liu, Wu, Li, Hu 2024", eigenvalues_only},
    {"lin2018",
     "LSPIA for singular systems: a step of each control point's own",
     "Lin, Cao, Zhang 2018",
     {}},
    {"plspia", "LSPIA preconditioned by compensated bands, of clouds by the axes' product",
     "Liu, Liu 2020", plspia_settings},
    {"anderson", "LSPIA with each control point's own step, the last moves combined",
     "Walker, Ni 2011", anderson_settings},
    {"pmlspia", "LSPIA with Polyak's momentum", "Polyak 1964; Liu, Wu, Li, Hu 2024",
     eigenvalues_only},
    {"rpia", "LSPIA of a block of control points at a time, drawn at random", "Wu, Liu 2022",
     rpia_settings},
    {"fairing-pia", "lin2018 with roughness, both by one weight", "Jiang, Lin 2022",
     fairing_settings},
    {"monotone-lspia", "LSPIA projected onto monotone control points", "Li, Che 2026",
     monotone_settings},
};

bool iterates(const MethodEntry& entry) {
    return entry.name != "auto" && entry.name != "search" && entry.name != "direct";
}

/// The method's setting of that name, nullptr when it has none.
const MethodSetting* find(const MethodEntry& entry, std::string_view name) {
    const auto own = std::ranges::find(entry.settings, name, &MethodSetting::name);
    if (own != entry.settings.end()) return &*own;
    const auto shape = std::ranges::find(of_kept_shape, name, &MethodSetting::name);
    return iterates(entry) && shape != std::end(of_kept_shape) ? shape : nullptr;
}

Preconditioner preconditioner(const MethodEntry& entry, const Settings& settings) {
    const bool plain = setting(entry, settings, "plain") == 1;
    const bool diagonal = setting(entry, settings, "diagonal") == 1;
    if (plain && diagonal)
        throw InvalidInput("settings plain = 1 and diagonal = 1 of method cg: one of them at most");
    return plain      ? Preconditioner::none
           : diagonal ? Preconditioner::diagonal
                      : Preconditioner::axes;
}

/// make_method for those at the end of the table; null for all others.
std::unique_ptr<Method> make_newer_method(const MethodEntry& entry, const NormalSystem& system,
                                          const Settings& settings) {
    const auto given = [&](const char* of) { return setting(settings, of); };
    const auto number = [&](const char* of) { return setting(entry, settings, of); };
    const auto whole = [&](const char* of) { return static_cast<int>(number(of)); };
    if (entry.name == "plspia")
        return std::make_unique<Plspia>(system, whole("band"), given("relaxation"),
                                        number("eigenvalue_tolerance"));
    if (entry.name == "anderson") return std::make_unique<Anderson>(system, whole("window"));
    if (entry.name == "pmlspia")
        return std::make_unique<Mlspia>(system, MlspiaWeights{}, number("eigenvalue_tolerance"),
                                        stated_row_sums(settings), "pmlspia");
    if (entry.name == "rpia")
        return std::make_unique<Rpia>(system, static_cast<Index>(given("block").value_or(0)),
                                      static_cast<std::uint64_t>(number("seed")));
    if (entry.name == "fairing-pia")
        return std::make_unique<FairingPia>(system, number("weight"), whole("order"));
    if (entry.name != "monotone-lspia") return nullptr;
    MonotoneLspia::Choice choice{.mu = given("mu"), .direction = whole("direction")};
    if (const auto one = given("coordinate")) choice.coordinate = static_cast<Index>(*one);
    return std::make_unique<MonotoneLspia>(system, choice);
}

} // namespace

std::optional<double> setting(const Settings& settings, const std::string& name) {
    const auto found = settings.find(name);
    return found == settings.end() ? std::nullopt : std::optional(found->second);
}

double setting(const MethodEntry& entry, const Settings& settings, const std::string& name) {
    return setting(settings, name).value_or(std::get<double>(find(entry, name)->otherwise));
}

std::optional<RowSums> stated_row_sums(const Settings& settings) {
    const std::optional<double> stated = setting(settings, "row_sums");
    if (!stated) return {};
    return *stated == 1 ? RowSums::always : RowSums::never;
}

std::span<const MethodEntry> methods() {
    return table;
}

std::span<const MethodSetting> shape_settings() {
    return of_kept_shape;
}

const MethodEntry& method_entry(std::string_view name) {
    std::vector<std::string_view> names;
    for (const MethodEntry& entry : table) {
        if (entry.name == name) return entry;
        names.push_back(entry.name);
    }
    throw InvalidInput(unknown_name("method", name, names));
}

void check_settings(const MethodEntry& entry, const Settings& settings) {
    std::vector<std::string_view> names;
    for (const MethodSetting& s : entry.settings) names.push_back(s.name);
    for (const auto& [name, value] : settings) {
        const MethodSetting* known = find(entry, name);
        if (known == nullptr && names.empty())
            throw InvalidInput(
                fmt::format("method {} has no settings, got '{}'", entry.name, name));
        if (known == nullptr)
            throw InvalidInput(
                unknown_name(fmt::format("setting of method {}", entry.name), name, names));
        check_setting(entry.name, name, value, known->range);
    }
}

void check_setting(std::string_view method, std::string_view name, double value) {
    check_settings(method_entry(method), {{std::string(name), value}});
}

std::unique_ptr<Method> make_method(std::string_view name, const NormalSystem& system,
                                    const Settings& settings) {
    const MethodEntry& entry = method_entry(name);
    check_settings(entry, settings);
    const auto given = [&](const char* of) { return setting(settings, of); };
    const auto number = [&](const char* of) { return setting(entry, settings, of); };
    const auto accuracy = [&] { return number("eigenvalue_tolerance"); };
    const auto row_sums = stated_row_sums(settings);
    const auto by_need = row_sums.value_or(RowSums::where_ill_determined);
    if (name == "lspia") return std::make_unique<Lspia>(system, given("mu"), accuracy(), row_sums);
    if (name == "mlspia")
        return std::make_unique<Mlspia>(
            system, MlspiaWeights{given("omega"), given("gamma"), given("nu"), given("lambda")},
            accuracy(), row_sums);
    if (name == "cg")
        return std::make_unique<ConjugateGradients>(system, preconditioner(entry, settings));
    if (name == "chebyshev") return std::make_unique<Chebyshev>(system, accuracy(), by_need);
    if (name == "nesterov" || name == "nmlspia")
        return std::make_unique<Nesterov>(system, accuracy(), entry.name, by_need);
    if (name == "barzilai-borwein")
        return std::make_unique<BarzilaiBorwein>(system, static_cast<int>(number("memory")));
    if (name == "salspia")
        return std::make_unique<Salspia>(system, static_cast<int>(number("memory")),
                                         static_cast<SpectralStep>(number("step")));
    if (name == "alspia")
        return std::make_unique<Alspia>(system, static_cast<Index>(number("cycle")), accuracy(),
                                        by_need);
    if (name == "lin2018") return std::make_unique<Lin2018>(system);
    if (auto method = make_newer_method(entry, system, settings)) return method;
    throw InvalidInput(fmt::format("method {} is no iteration on the normal equations", name));
}

} // namespace batten
