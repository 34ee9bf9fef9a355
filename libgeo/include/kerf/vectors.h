// The vectors that kernels compute with. Steps of a simulation depend on them in last digits.
#pragma once

namespace geo {

/// Which vectors kernels use.
enum class Vectors {
  widest,    ///< the widest that the processor has, with products fused to sums where it fuses them
  portable,  ///< of two doubles, without fused products: the bytes of any x86 processor, and of WebAssembly
};

/// Chooses for all later calls. Must be called while no other call runs. In WebAssembly vectors are
/// always the portable ones; on other processors than x86 there is no choice.
void set_vectors(Vectors kind);

/// The kind that is in use. In WebAssembly that is the portable one.
Vectors vectors();

}  // namespace geo
