#include <batten/search/curve_exchange.hpp>

#include <batten/core/distinct.hpp>
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
constexpr Index first_stretches = 1000;   // see representatives()
constexpr Index finer = 4;                // times as many stretches where these do not suffice
constexpr Index least_part = 3;           // some of the samples: at most a third
constexpr Index samples_per_control = 32; // so many tell what a control point does

/// Searches by some samples, at one number of stretches.
class Exchange {
  public:
    Exchange(CurveTask& all, Index most, const CurveSearch& search, Index& checks)
        : all_(all), most_(most), search_(search), checks_(checks) {}

    /// A curve that holds for all samples; or, where only the stated number of control points keeps
    /// it from them, the one that the search left. Nothing where these samples do not suffice.
    std::optional<CurveWithin> by(Index stretches) {
        constexpr int most_rounds = 3;
        for (int k = 0; k < most_rounds; ++k) {
            std::vector<Candidate> candidates = searched(stretches);
            if (candidates.empty()) return {};
            if (!candidates.front().found.met) return limited(std::move(candidates.front()));
            for (Candidate& candidate : candidates)
                if (candidate.found.met && holds_for_all(candidate))
                    return std::move(candidate.found);
        }
        return {};
    }

  private:
    struct Candidate {
        std::unique_ptr<ThinnedTask> some;
        CurveWithin found;
    };

    /// What is found by ever more samples, for which knots can go is a matter of luck: the fewest
    /// control points first; what is not met last, the most samples first.
    std::vector<Candidate> searched(Index stretches) {
        std::vector<Candidate> result;
        for (Index times : {1, 2, 3}) {
            std::vector<Index> kept = representatives(all_, times * stretches);
            if (static_cast<Index>(kept.size()) > all_.samples.size() / least_part) break;
            kept.insert(kept.end(), offenders_.begin(), offenders_.end());
            Candidate next{std::make_unique<ThinnedTask>(all_, distinct(std::move(kept))), {}};
            next.found = search_(next.some->task(), std::min(most_, told(*next.some)));
            next.found.searched = next.some->task().samples.size();
            result.push_back(std::move(next));
        }
        std::ranges::stable_sort(result, {}, [](const Candidate& c) {
            return std::pair(!c.found.met, c.found.met ? controls(c.found) : -c.found.searched);
        });
        return result;
    }

    /// Control points of which the samples tell.
    static Index told(ThinnedTask& some) {
        return some.task().samples.size() / samples_per_control;
    }

    bool holds_for_all(Candidate& candidate) {
        const std::vector<Index> before = all_.corners;
        take_corners(candidate.some->original(candidate.some->task().corners));
        std::optional<CurveTrial> trial =
            for_all(std::move(candidate.some), std::move(candidate.found.trial));
        if (trial)
            candidate.found.trial = std::move(*trial);
        else
            take_corners(before);
        return trial.has_value();
    }

    void take_corners(std::vector<Index> corners) {
        all_.corners = std::move(corners);
        all_.fixed = fixed_samples(all_);
    }

    /// The trial settled on ever more of the samples that break the tolerance, where it can be.
    std::optional<CurveTrial> for_all(std::unique_ptr<ThinnedTask> some, CurveTrial trial) {
        constexpr int most_exchanges = 8;
        for (int k = 0; k < most_exchanges; ++k) {
            CurveTrial all = some->carried(trial);
            ++checks_;
            if (all.worst <= 1) return refitted(std::move(all));
            std::vector<Index> kept = some->kept();
            if (!add_offenders(all, kept, offenders_)) return {};
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
        ++checks_;
        if (settle(all_, again, 1, KnotShift::none) && !is_wild(all_, again)) return again;
        if (is_wild(all_, within)) return {};
        return within;
    }

    /// What is left where nothing was found: an answer if no more control points were allowed.
    std::optional<CurveWithin> limited(Candidate left) {
        CurveWithin& found = left.found;
        if (most_ > told(*left.some) || !std::isfinite(found.trial.worst) || found.trial.worst <= 1)
            return {};
        take_corners(left.some->original(left.some->task().corners));
        const ClosestSeen closest = std::exchange(found.closest, {});
        found.trial = left.some->carried(found.trial);
        found.closest.see(all_, found.trial);
        if (closest.trial()) found.closest.see(all_, left.some->carried(*closest.trial()));
        checks_ += 2;
        return std::move(found);
    }

    CurveTask& all_;
    Index most_;
    const CurveSearch& search_;
    Index& checks_;
    std::vector<Index> offenders_; ///< of any candidate
};

} // namespace

CurveWithin by_exchange(CurveTask& task, Index most, const CurveSearch& search) {
    const Index m = task.samples.size();
    Index checks = 0;
    for (Index stretches = first_stretches; m > few_enough && m / least_part > stretches;
         stretches *= finer) {
        if (auto found = Exchange(task, most, search, checks).by(stretches)) {
            found->full_checks = checks;
            return std::move(*found);
        }
    }
    return search(task, most);
}

} // namespace batten
