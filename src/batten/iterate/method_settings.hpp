#pragma once

#include <batten/basis/active_functions.hpp>
#include <batten/iterate/method.hpp>
#include <batten/iterate/setting.hpp>

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
