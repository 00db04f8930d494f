#pragma once
// clang-format off

// All public headers, bottom floor first.
#include <batten/core/core.hpp>
#include <batten/samples/generate.hpp>
#include <batten/samples/sample_source.hpp>
#include <batten/samples/samples.hpp>
#include <batten/parametrize/parametrize.hpp>
#include <batten/parametrize/project.hpp>
#include <batten/basis/basis_functions.hpp>
#include <batten/basis/knot_vector.hpp>
#include <batten/basis/nested_knots.hpp>
#include <batten/basis/place_knots.hpp>
#include <batten/spline/spline.hpp>
#include <batten/system/normal_system.hpp>
#include <batten/system/system_sums.hpp>
#include <batten/measure/deviation.hpp>
#include <batten/io/points_file.hpp>
#include <batten/io/spline_file.hpp>
#include <batten/io/system_file.hpp>
#include <batten/solve/direct.hpp>
#include <batten/solve/extreme_eigenvalues.hpp>
#include <batten/iterate/iterate.hpp>
#include <batten/iterate/methods.hpp>
#include <batten/fair/fair.hpp>
#include <batten/drivers/table.hpp>
#include <batten/fit/fit.hpp>
#include <batten/fit/assemble_system.hpp>
#include <batten/fit/solve_system.hpp>
#include <batten/report/html.hpp>
