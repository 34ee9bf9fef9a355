// Animations: .webp by libwebp, .mp4 by an installed ffmpeg.
#pragma once

#include <functional>
#include <ostream>
#include <string>

#include "view/picture.h"

namespace view {

/// Makes picture i of a sequence. All have one size, and are requested in order.
using Sequence = std::function<Picture(int i)>;

/// Writes an animated WebP that repeats for ever: `count` ≥ 1 pictures, `frame_rate` > 0 pictures a
/// second. Throws geo::OutputError.
void write_webp(std::ostream& out, int count, double frame_rate, const Sequence& picture);

/// Writes H.264 in MP4, to a temporary file that is then renamed. Arguments as in write_webp().
/// Throws geo::OutputError where it cannot be written, or ffmpeg is missing. Precondition: SIGPIPE
/// is ignored.
void write_mp4(const std::string& path, int count, double frame_rate, const Sequence& picture);

}  // namespace view
