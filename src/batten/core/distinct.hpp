#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace batten {

/// The values with each run of equal ones told once.
template <class Value>
std::vector<Value> without_repeats(std::vector<Value> values) {
    values.erase(std::unique(values.begin(), values.end()), values.end());
    return values;
}

/// The distinct values, ascending.
template <class Value>
std::vector<Value> distinct(std::vector<Value> values) {
    std::ranges::sort(values);
    return without_repeats(std::move(values));
}

} // namespace batten
