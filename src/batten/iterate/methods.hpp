#pragma once

#include <batten/iterate/method.hpp>
#include <batten/iterate/setting.hpp>
#include <batten/iterate/step_gradient.hpp>
#include <batten/system/normal_system.hpp>

#include <memory>
#include <optional>
#include <span>

namespace batten {

/// The settings of a method, given or the table's.
struct ChosenSettings;
/// Makes the iteration on a normal system.
using MethodMaker = std::unique_ptr<Method> (*)(const NormalSystem&, const ChosenSettings&);

/// What a user can ask for by name.
struct MethodEntry {
    std::string_view name;
    std::string_view description;
    std::string_view source; ///< empty for what is common knowledge
    std::span<const MethodSetting> settings;
    MethodMaker make = nullptr; ///< null: no iteration, or one that needs more than the system
    bool needs_samples = false; ///< an iteration that has no sense for a fairing's displacements
};

/// Everything that can be asked for by name, with its settings.
std::span<const MethodEntry> methods();

/// The settings that every iteration has besides its own: how it keeps a shape.
std::span<const MethodSetting> shape_settings();

/// The entry of a method; throws InvalidInput for an unknown name (the nearest is suggested).
const MethodEntry& method_entry(std::string_view name);

/// Throws InvalidInput when the method has no setting of one of the names, or a value is outside
/// its range.
void check_settings(const MethodEntry& entry, const Settings& settings);

/// The same of one setting, for the methods' own constructors.
void check_setting(std::string_view method, std::string_view name, double value);

/// The setting of that name; nothing when it was not given.
std::optional<double> setting(const Settings& settings, const std::string& name);

/// The setting of that name; the number of the table when it was not given.
double setting(const MethodEntry& entry, const Settings& settings, const std::string& name);

/// What `row_sums` says; nothing when it was not given.
std::optional<RowSums> stated_row_sums(const Settings& settings);

/// The iteration `name` on a normal system alone: not `auto` or `direct`, which are no iterations,
/// nor `pia`, `epia` and `clspia`, which need more than the system.
std::unique_ptr<Method> make_method(std::string_view name, const NormalSystem& system,
                                    const Settings& settings);

} // namespace batten
