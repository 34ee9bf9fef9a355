// Several edits of a complex as one.
#pragma once

#include "kerf/complex.h"

namespace geo {

/// Edits that are applied while this lives count as one: Complex::undo() reverts them together.
/// Unless they are kept, the destructor reverts them. One group at a time.
class Complex::EditGroup {
 public:
  /// Edits of `complex`, which must outlive the group.
  explicit EditGroup(Complex& complex);
  /// Reverts the edits that are not kept.
  ~EditGroup();
  EditGroup(const EditGroup&) = delete;
  EditGroup& operator=(const EditGroup&) = delete;
  /// The edits stay.
  void keep() { is_kept_ = true; }

 private:
  Complex& complex_;
  bool is_kept_ = false;
};

}  // namespace geo
