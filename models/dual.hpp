#pragma once
/// \file
/// Dual numbers with their arithmetic, for programs that compute with them. Laws and their batches
/// do without (ceres/jet.h brings Eigen along, seconds of compiling).

#include <ceres/jet.h>

#include "models/scalar.hpp"
