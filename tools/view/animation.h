// Pictures that move: .webp by libwebp, .mp4 by the ffmpeg that is installed.
#pragma once

#include <functional>
#include <ostream>
#include <string>

#include "view/picture.h"

namespace view {

/// Makes picture i of a sequence; all are of one size, asked for in order.
using Sequence = std::function<Picture(int i)>;

/// An animated WebP that repeats for ever. Throws geo::OutputError.
void write_webp(std::ostream& out, int count, double frame_rate, const Sequence& picture);

/// H.264 in MP4, aside and renamed. Throws geo::OutputError: it cannot be written, or there is no ffmpeg.
void write_mp4(const std::string& path, int count, double frame_rate, const Sequence& picture);

}  // namespace view
