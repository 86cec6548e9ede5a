#pragma once
// What a file of operators/combining/ is written with. The build includes each such file in a source that it
// generates (cmake/registry.cmake): the part under `#if TAFONI_KERNELS` once for every instruction set, among
// what operator-inl.h defines, the other part once.

#include <algorithm>
#include <cmath>

#include "tafoni/field/operator.h"
#include "tafoni/math/vec.h"
