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

struct ChosenSettings {
    const MethodEntry& entry;
    const Settings& given;

    std::optional<double> stated(const char* name) const { return setting(given, name); }
    double number(const char* name) const { return setting(entry, given, name); }
    template <class Whole = int>
    Whole whole(const char* name) const {
        return static_cast<Whole>(number(name));
    }
    double accuracy() const { return number("eigenvalue_tolerance"); }
    std::optional<RowSums> row_sums() const { return stated_row_sums(given); }
    RowSums row_sums_by_need() const { return row_sums().value_or(RowSums::where_ill_determined); }
};

namespace {

using namespace method_settings;
using Made = std::unique_ptr<Method>;
using Chosen = ChosenSettings;

Made lspia(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<Lspia>(system, s.stated("mu"), s.accuracy(), s.row_sums());
}

Made mlspia(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<Mlspia>(
        system,
        MlspiaWeights{s.stated("omega"), s.stated("gamma"), s.stated("nu"), s.stated("lambda")},
        s.accuracy(), s.row_sums());
}

Made pmlspia(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<Mlspia>(system, MlspiaWeights{}, s.accuracy(), s.row_sums(), "pmlspia");
}

Made conjugate_gradients(const NormalSystem& system, const Chosen& s) {
    const bool plain = s.number("plain") == 1;
    const bool diagonal = s.number("diagonal") == 1;
    if (plain && diagonal)
        throw InvalidInput("settings plain = 1 and diagonal = 1 of method cg: one of them at most");
    return std::make_unique<ConjugateGradients>(system, plain      ? Preconditioner::none
                                                        : diagonal ? Preconditioner::diagonal
                                                                   : Preconditioner::axes);
}

Made chebyshev(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<Chebyshev>(system, s.accuracy(), s.row_sums_by_need());
}

/// nesterov and nmlspia.
Made nesterov(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<Nesterov>(system, s.accuracy(), s.entry.name, s.row_sums_by_need());
}

Made barzilai_borwein(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<BarzilaiBorwein>(system, s.whole("memory"));
}

Made salspia(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<Salspia>(system, s.whole("memory"), s.whole<SpectralStep>("step"));
}

Made alspia(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<Alspia>(system, s.whole<Index>("cycle"), s.accuracy(),
                                    s.row_sums_by_need());
}

Made lin2018(const NormalSystem& system, const Chosen&) {
    return std::make_unique<Lin2018>(system);
}

Made plspia(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<Plspia>(system, s.whole("band"), s.stated("relaxation"), s.accuracy());
}

Made anderson(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<Anderson>(system, s.whole("window"));
}

Made rpia(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<Rpia>(system, static_cast<Index>(s.stated("block").value_or(0)),
                                  s.whole<std::uint64_t>("seed"));
}

Made fairing_pia(const NormalSystem& system, const Chosen& s) {
    return std::make_unique<FairingPia>(system, s.number("weight"), s.whole("order"));
}

Made monotone_lspia(const NormalSystem& system, const Chosen& s) {
    MonotoneLspia::Choice choice{.mu = s.stated("mu"), .direction = s.whole("direction")};
    if (const auto one = s.stated("coordinate")) choice.coordinate = static_cast<Index>(*one);
    return std::make_unique<MonotoneLspia>(system, choice);
}

constexpr MethodEntry table[]{
    {"auto", "the fastest that answers the question", "", {}},
    {"search", "the fewest control points within a tolerance", "", {}},
    {"direct", "banded Cholesky of the normal equations, axis by axis", "", {}},
    {"lspia", "least-squares PIA", "Deng, Lin 2014", lspia_settings, lspia},
    {"mlspia", "least-squares PIA with memory", "Huang, Wang 2020", mlspia_settings, mlspia},
    {"clspia", "LSPIA with Lagrange multipliers: exact at the interpolated samples",
     "Chang, Ma, Deng 2023", clspia_settings},
    {"pia", "progressive-iterative approximation: interpolates every sample",
     "Lin, Wang, Dong 2004", pia_settings},
    {"epia", "PIA with groups of samples, knots added where the error is", "Lin, Zhang 2011",
     epia_settings},
    {"cg", "conjugate gradients, preconditioned axis by axis on clouds, by the diagonal elsewhere",
     "Hestenes, Stiefel 1952", cg_settings, conjugate_gradients},
    {"chebyshev", "LSPIA with Chebyshev steps", "Golub, Varga 1961", eigenvalues_only, chebyshev},
    {"nesterov", "LSPIA with Nesterov's momentum", "Nesterov 2004", eigenvalues_only, nesterov},
    {"barzilai-borwein", "LSPIA with Barzilai-Borwein steps and a non-monotone search",
     "Barzilai, Borwein 1988; Grippo, Lampariello, Lucidi 1986", barzilai_borwein_settings,
     barzilai_borwein},
    {"salspia", "LSPIA with steps that adapt to the spectrum, without eigenvalues", "Peng, Li 2026",
     salspia_settings, salspia},
    {"alspia", "LSPIA with one over Chebyshev roots as steps", "Wu, Liu 2024", alspia_settings,
     alspia},
    {"nmlspia", "LSPIA with Nesterov's momentum", "Liu, Wu, Li, Hu 2024", eigenvalues_only,
     nesterov},
    {"lin2018",
     "LSPIA for singular systems: a step of each control point's own",
     "Lin, Cao, Zhang 2018",
     {},
     lin2018},
    {"plspia", "LSPIA preconditioned by compensated bands, of clouds by the axes' product",
     "Liu, Liu 2020", plspia_settings, plspia},
    {"anderson", "LSPIA with each control point's own step, the last moves combined",
     "Walker, Ni 2011", anderson_settings, anderson},
    {"pmlspia", "LSPIA with Polyak's momentum", "Polyak 1964; Liu, Wu, Li, Hu 2024",
     eigenvalues_only, pmlspia},
    {"rpia", "LSPIA of a block of control points at a time, drawn at random", "Wu, Liu 2022",
     rpia_settings, rpia},
    {"fairing-pia", "lin2018 with roughness, both by one weight", "Jiang, Lin 2022",
     fairing_settings, fairing_pia, true},
    {"monotone-lspia", "LSPIA projected onto monotone control points", "Li, Che 2026",
     monotone_settings, monotone_lspia, true},
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
    if (entry.make != nullptr) return entry.make(system, {entry, settings});
    throw InvalidInput(fmt::format("method {} is no iteration on the normal equations", name));
}

} // namespace batten
