#pragma once
// From kernels compiled once for every instruction set to the table of the one this machine has.

#include <hwy/highway.h>

/// In namespace tafoni::field, once a file: defines `const impl::Table& kernels()` over impl::HWY_NAMESPACE's
/// NAME_kernels().
#define TAFONI_KERNEL_TABLE(Table, name)                                           \
  namespace impl {                                                                 \
  HWY_EXPORT(name##_kernels);                                                      \
  }                                                                                \
  namespace {                                                                      \
  const impl::Table& kernels() {                                                   \
    static const impl::Table table = HWY_DYNAMIC_DISPATCH(impl::name##_kernels)(); \
    return table;                                                                  \
  }                                                                                \
  }
