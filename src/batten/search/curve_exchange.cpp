#include <batten/search/curve_exchange.hpp>

#include <batten/search/curve_corners.hpp>
#include <batten/search/curve_knots.hpp>
#include <batten/search/thinned_task.hpp>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

namespace batten {

namespace {

constexpr Index few_enough = 20000;       // samples that are searched by all of them
constexpr Index first_stretches = 3000;   // see representatives()
constexpr Index finer = 4;                // times as many stretches where these do not suffice
constexpr Index least_part = 3;           // some of the samples: at most a third
constexpr Index samples_per_control = 16; // so many tell what a control point does

/// Searches by some samples, at one number of stretches.
class Exchange {
  public:
    Exchange(CurveTask& all, Index most, const CurveSearch& search, Index& passes)
        : all_(all), most_(most), search_(search), passes_(passes) {}

    /// A curve that holds for all samples; or, where only the stated number of control points keeps
    /// it from them, the one that the search left. Nothing where these samples do not suffice.
    std::optional<CurveWithin> by(std::vector<Index> kept) {
        constexpr int most_searches = 4;
        for (int k = 0; k < most_searches; ++k) {
            ThinnedTask some(all_, kept);
            const Index fewest = static_cast<Index>(kept.size()) / samples_per_control;
            CurveWithin found = search_(some.task(), std::min(most_, fewest));
            found.searched = static_cast<Index>(kept.size());
            if (!found.met) {
                if (most_ > fewest || !std::isfinite(found.trial.worst) || found.trial.worst <= 1)
                    return {};
                return missed(some, std::move(found));
            }
            if (std::optional<CurveTrial> trial = for_all(found.trial, kept)) {
                take_corners(some);
                found.trial = std::move(*trial);
                return found;
            }
        }
        return {};
    }

  private:
    /// The trial settled on ever more of the samples that break the tolerance, which are kept.
    std::optional<CurveTrial> for_all(CurveTrial trial, std::vector<Index>& kept) {
        constexpr int most_exchanges = 8;
        auto some = std::make_unique<ThinnedTask>(all_, kept);
        for (int k = 0; k < most_exchanges; ++k) {
            CurveTrial all = some->carried(trial);
            ++passes_;
            if (all.worst <= 1) return refitted(std::move(all));
            if (!add_offenders(all, kept)) return {};
            auto more = std::make_unique<ThinnedTask>(all_, kept);
            trial = more->restricted(all, *some, trial.weights);
            some = std::move(more);
            if (!settle_well(some->task(), trial)) return {};
        }
        return {};
    }

    /// Settles a trial, a little within the tolerances where that can be: for samples not among
    /// these.
    static bool settle_well(const CurveTask& task, CurveTrial& trial) {
        constexpr double a_little = 0.995;
        settle(with_tolerances(task, a_little), trial, trial_rounds, KnotShift::allowed);
        trial = rescaled(std::move(trial), a_little);
        return trial.worst <= 1;
    }

    /// The least-squares curve for all samples on the same knots, where it is within tolerance.
    std::optional<CurveTrial> refitted(CurveTrial within) {
        within.weights = first_weights(all_);
        CurveTrial again = within;
        ++passes_;
        if (settle(all_, again, 1, KnotShift::none) && !is_wild(all_, again)) return again;
        if (is_wild(all_, within)) return {};
        return within;
    }

    CurveWithin missed(const ThinnedTask& some, CurveWithin found) {
        const auto closest = std::exchange(found.closest, {});
        found.trial = some.carried(found.trial);
        found.closest.see(all_, found.trial);
        if (closest.trial()) found.closest.see(all_, some.carried(*closest.trial()));
        passes_ += 2;
        return found;
    }

    void take_corners(ThinnedTask& some) {
        all_.corners = some.original(some.task().corners);
        all_.fixed = fixed_samples(all_);
    }

    CurveTask& all_;
    Index most_;
    const CurveSearch& search_;
    Index& passes_;
};

} // namespace

CurveWithin by_exchange(CurveTask& task, Index most, const CurveSearch& search) {
    const Index m = task.samples.size();
    Index passes = 0;
    for (Index stretches = first_stretches; m > few_enough && m / least_part > stretches;
         stretches *= finer) {
        std::vector<Index> kept = representatives(task, stretches);
        if (static_cast<Index>(kept.size()) > m / least_part) break;
        if (auto found = Exchange(task, most, search, passes).by(std::move(kept))) {
            found->passes = passes;
            return std::move(*found);
        }
    }
    return search(task, most);
}

} // namespace batten
