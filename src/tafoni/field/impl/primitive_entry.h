#pragma once
// What a file of primitives/ is written with. The build includes each such file in a source that it generates
// (cmake/registry.cmake): the part under `#if TAFONI_KERNELS` once for every instruction set, among what
// primitive-inl.h and skeleton-inl.h define, the other part once.

#include <algorithm>
#include <cmath>
#include <span>

#include "tafoni/field/primitive.h"
#include "tafoni/math/vec.h"
