#pragma once

#include <batten/core/closure.hpp>
#include <batten/core/errors.hpp>
#include <batten/core/grid_index.hpp>
#include <batten/core/index.hpp>
#include <batten/core/points.hpp>
#include <batten/core/threads.hpp>
