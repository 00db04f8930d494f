#pragma once

#include <batten/iterate/method.hpp>
#include <batten/system/normal_system.hpp>

#include <memory>
#include <span>
#include <vector>

namespace batten {

/// A method's own setting, given as `--set name=value`.
struct MethodSetting {
    std::string_view name;
    std::string_view meaning;
};

/// What a user can ask for by name.
struct MethodEntry {
    std::string_view name;
    std::string_view description;
    std::string_view source;
    std::vector<MethodSetting> settings;
};

/// Every method of fitting with a fixed number of control points, `auto` and `direct` included.
std::span<const MethodEntry> methods();

/// The entry of a method; throws InvalidInput for an unknown name (the nearest is suggested).
const MethodEntry& method_entry(std::string_view name);

/// Throws InvalidInput when the method has no setting of one of the names, or a value is not
/// finite.
void check_settings(const MethodEntry& entry, const Settings& settings);

/// The setting of that name, or `otherwise`.
double setting(const Settings& settings, const std::string& name, double otherwise);

/// The iteration `name` on a normal system alone: not `auto` or `direct`, which are no iterations,
/// nor `pia`, `epia` and `clspia`, which need more than the system.
std::unique_ptr<Method> make_method(std::string_view name, const NormalSystem& system,
                                    const Settings& settings);

} // namespace batten
