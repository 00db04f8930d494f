#pragma once

#include <batten/basis/active_functions.hpp>
#include <batten/iterate/method.hpp>
#include <batten/iterate/setting.hpp>
#include <batten/shape/limits.hpp>

/// What the table of methods is made of.
namespace batten::method_settings {

inline constexpr auto open = RangeEnd::open;
inline constexpr auto closed = RangeEnd::closed;
inline constexpr double largest_count = 1e6;
inline constexpr SettingRange any_number{};
inline constexpr SettingRange positive{.low = 0};
inline constexpr SettingRange switched{0, 1, closed, closed, Numbers::whole};
inline constexpr SettingRange counts{0, largest_count, closed, closed, Numbers::whole};
inline constexpr SettingRange counts_from_one{1, largest_count, closed, closed, Numbers::whole};

inline constexpr MethodSetting eigenvalue_setting{
    "eigenvalue_tolerance", "relative accuracy of the extreme eigenvalues of A^T A",
    default_eigenvalue_tolerance, SettingRange{0, 1, open, open}};

/// Whether gradients are taken over row sums, by every method that chooses steps by eigenvalues.
inline constexpr MethodSetting row_sum_setting{
    "row_sums", "1: gradients over the row sums of A^T A, 0: as they are",
    "1 where samples leave directions ill-determined and no step factor is stated", switched,
    "Lin, Cao, Zhang 2018"};

inline constexpr MethodSetting eigenvalues_only[]{eigenvalue_setting, row_sum_setting};

inline constexpr MethodSetting lspia_settings[]{
    {"mu", "step factor", "2 / (sigma_1^2 + sigma_r^2), over row sums 1", positive,
     "Deng, Lin 2014, eq. 18"},
    eigenvalue_setting,
    row_sum_setting,
};

inline constexpr MethodSetting mlspia_settings[]{
    {"omega", "1 - omega of the last move is kept", "eq. 27, for grids eq. 37",
     SettingRange{0, 2, open, open}, "Huang, Wang 2020, eq. 3 and 11"},
    {"gamma", "weight of the gradient at hand, the last one's is omega - gamma",
     "eq. 27, for grids eq. 37", any_number, "Huang, Wang 2020, eq. 3 and 11"},
    {"nu", "step factor", "eq. 27, for grids eq. 37; less where omega and gamma ask for it",
     positive, "Huang, Wang 2020, eq. 3 and 11"},
    {"lambda", "Lambda^0 in parts of the residual Q - A P^0", "omega, as in section 6.2",
     any_number, "Huang, Wang 2020, eq. 2 and section 6.2"},
    eigenvalue_setting,
    row_sum_setting,
};

inline constexpr MethodSetting clspia_settings[]{
    {"mu", "outer step: of the multipliers",
     "the inverse of S, beta_min to beta_max its eigenvalues", positive,
     "Chang, Ma, Deng 2023, eq. 10"},
    {"mu_1", "inverse of the inner step: of the control points", "(gamma_min + gamma_max) / 2",
     positive, "Chang, Ma, Deng 2023, eq. 8"},
    {"inner_tolerance", "longest move that ends the inner loop",
     "two moves; where mu or mu_1 is stated a hundredth of the largest constraint error", positive,
     "Chang, Ma, Deng 2023, Algorithm 2"},
    {"lambda", "every component of the multipliers at the start", 0.0, any_number,
     "Chang, Ma, Deng 2023, section 3.2: 1; its tables: 0"},
    {"warm_start", "LSPIA steps before the first iteration", 0.0, counts,
     "Chang, Ma, Deng 2023, section 4"},
    eigenvalue_setting,
    {"row_sums", "1: inner steps over the row sums of A^T A, 0: all alike",
     "1 where neither factor is stated", switched, "Lin, Cao, Zhang 2018"},
};

inline constexpr MethodSetting pia_settings[]{
    {"weight", "factor of every move", 1.0, SettingRange{0, 2, open, closed}, "Lu 2010"},
    {"best_weight", "1: the weight of the least rate, 2 / (1 + the smallest eigenvalue)", 0.0,
     switched, "Lu 2010"},
    {"threshold",
     "D: where the search for a kept shape's factor ends, in parts of the longest move",
     default_turn_threshold, SettingRange{0, 1, open, open}, "Lin, Wang, Dong 2004, Algorithm 1"},
};

inline constexpr MethodSetting epia_settings[]{
    {"eta", "validation threshold of a group", 0.6, SettingRange{0, 1, closed, open},
     "Lin, Zhang 2011, eq. 47"},
    {"t_c", "longest move e_c below which a knot is inserted",
     "0.9 of the stop deviation, else 2.5e-3 of the data's size", positive,
     "Lin, Zhang 2011, Algorithm 1"},
    {"rounds", "most rounds of the validation check, which goes on until it holds", 100.0, counts,
     "Lin, Zhang 2011, section 4"},
    {"smoothing", "widest Gaussian of the curvature, in samples", 4.0, counts,
     "Lin, Zhang 2011, section 4"},
    {"exact", "1: keep the refined knots instead of regenerating them", 0.0, switched,
     "Lin, Zhang 2011, eq. 38"},
    {"screen", "0: every maximum of the curvature is dominant, noise or not", 1.0, switched},
};

inline constexpr MethodSetting cg_settings[]{
    {"plain", "1: without the preconditioner", 0.0, switched},
    {"diagonal", "1: preconditioned by the diagonal on clouds, too", 0.0, switched},
};

inline constexpr MethodSetting barzilai_borwein_settings[]{
    {"memory", "energies that the search looks back on", 10.0, counts_from_one,
     "Grippo, Lampariello, Lucidi 1986"},
};

inline constexpr MethodSetting salspia_settings[]{
    {"memory", "functionals that the search looks back on", 10.0, counts_from_one, "Peng, Li 2026"},
    {"step", "0: blended, 1: Barzilai and Borwein's longer one, 2: their shorter one", 0.0,
     SettingRange{0, 2, closed, closed, Numbers::whole}, "Peng, Li 2026"},
};

inline constexpr MethodSetting alspia_settings[]{
    {"cycle", "Chebyshev roots taken in turn; the authors' 10000 overflow in long runs", 16.0,
     counts_from_one, "Wu, Liu 2024"},
    eigenvalue_setting,
    row_sum_setting,
};

inline constexpr MethodSetting of_kept_shape[]{
    {"alpha", "part of the way to a line through its neighbours that a control point may go", 0.8,
     SettingRange{0, 1, open, open}, "Chang, Ma, Deng 2023, section 4.4"},
    {"rays", "1: only the rays that are printed stop it, and turns do change sign", 0.0, switched,
     "Chang, Ma, Deng 2023, section 4.4"},
};

inline constexpr MethodSetting anderson_settings[]{
    {"window", "moves that are combined", 10.0,
     SettingRange{1, 100, closed, closed, Numbers::whole}, "Walker, Ni 2011"},
};

inline constexpr MethodSetting rpia_settings[]{
    {"block", "control points in a block", "a quarter of them", counts_from_one, "Wu, Liu 2022"},
    {"seed", "of the random numbers that draw the blocks", 1.0, counts},
};

inline constexpr MethodSetting plspia_settings[]{
    {"band", "diagonals of M beside the middle, of sequences and grids of equal weights", 1.0,
     SettingRange{0, max_degree, closed, closed, Numbers::whole}, "Liu, Liu 2020"},
    {"relaxation", "factor of every step", "2 / (largest + smallest eigenvalue of M^-1 A^T A)",
     positive},
    eigenvalue_setting,
};

inline constexpr MethodSetting monotone_settings[]{
    {"mu", "step factor", "0.99 of 2 / largest row sum", positive, "Li, Che 2026"},
    {"coordinate", "the one that is kept monotone, from 0", "all", counts},
    {"direction", "1: rising, -1: falling, 0: as a line through the samples", 0.0,
     SettingRange{-1, 1, closed, closed, Numbers::whole}},
};

inline constexpr MethodSetting fairing_settings[]{
    {"weight", "w of the roughness beside 1 - w of the squares", 1e-4,
     SettingRange{0, 1, open, open}, "Jiang, Lin 2022"},
    {"order", "of the derivatives in the roughness", 2.0,
     SettingRange{2, 3, closed, closed, Numbers::whole}, "Jiang, Lin 2022"},
};

} // namespace batten::method_settings
