// Frames are encoded as they arrive: by libwebp in memory, or piped as raw RGB to ffmpeg.
#include "view/animation.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>
#include <webp/encode.h>
#include <webp/mux.h>

#include <cerrno>
#include <cmath>
#include <cstring>
#include <memory>

#include <kerf/error.h>
#include <kerf/files.h>

extern char** environ;

namespace view {
namespace {

[[noreturn]] void fail(const std::string& what) { throw geo::OutputError("the animation cannot be made: " + what); }

// A WebP picture, freed by the destructor.
struct WebpPicture : WebPPicture {
  explicit WebpPicture(const Picture& from) {
    if (!WebPPictureInit(this)) fail("libwebp is of another version");
    width = from.width;
    height = from.height;
    use_argb = 1;
    if (!WebPPictureImportRGB(this, rgb_bytes(from).data(), 3 * from.width)) fail("out of memory");
  }
  ~WebpPicture() { WebPPictureFree(this); }
  WebpPicture(const WebpPicture&) = delete;
};

// A child process that reads its standard input. SIGPIPE is ignored (tools/tool.cpp): a write to a
// program that has ended fails.
class PipedProgram {
 public:
  explicit PipedProgram(const std::vector<std::string>& command) : program_(command[0]) {
    int pipe_ends[2];
    if (::pipe2(pipe_ends, O_CLOEXEC) != 0) fail("no pipe");
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, pipe_ends[0], 0);
    std::vector<char*> argv;
    for (const auto& w : command) argv.push_back(const_cast<char*>(w.c_str()));
    argv.push_back(nullptr);
    const int error = ::posix_spawnp(&pid_, argv[0], &actions, nullptr, argv.data(), environ);
    posix_spawn_file_actions_destroy(&actions);
    ::close(pipe_ends[0]);
    to_program_ = pipe_ends[1];
    if (error != 0) {
      ::close(to_program_);
      fail(error == ENOENT ? program_ + " is not installed; install it, or write .webp"
                           : program_ + " cannot be started: " + std::strerror(error));
    }
  }
  ~PipedProgram() { end(); }
  PipedProgram(const PipedProgram&) = delete;
  void put(const std::vector<std::uint8_t>& bytes) {
    for (std::size_t at = 0; at < bytes.size();) {
      const auto n = ::write(to_program_, bytes.data() + at, bytes.size() - at);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) fail(program_ + " stopped early");
      at += static_cast<std::size_t>(n);
    }
  }
  // Closes its input and waits for it. Returns the status of waitpid(): 0 if it succeeded.
  int end() {
    if (to_program_ < 0) return status_;
    ::close(to_program_);
    to_program_ = -1;
    while (::waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
    }
    return status_;
  }

 private:
  std::string program_;
  pid_t pid_ = 0;
  int to_program_ = -1, status_ = 0;
};

}  // namespace

void write_webp(std::ostream& out, int count, double frame_rate, const Sequence& picture) {
  if (count < 1) fail("it has no pictures");
  std::unique_ptr<WebPAnimEncoder, void (*)(WebPAnimEncoder*)> encoder(nullptr, WebPAnimEncoderDelete);
  WebPConfig config;
  if (!WebPConfigInit(&config)) fail("libwebp is of another version");
  config.quality = 82;  // of 100; libwebp's default is 75. Higher: better pictures, larger files
  const auto milliseconds = [&](int frame) { return static_cast<int>(std::lround(1000 * frame / frame_rate)); };
  for (int i = 0; i < count; ++i) {
    const Picture shown = picture(i);
    if (!encoder) encoder.reset(WebPAnimEncoderNew(shown.width, shown.height, nullptr));
    WebpPicture frame(shown);
    if (!encoder || !WebPAnimEncoderAdd(encoder.get(), &frame, milliseconds(i), &config))
      fail(encoder ? WebPAnimEncoderGetError(encoder.get()) : "out of memory");
  }
  WebPData data;
  WebPDataInit(&data);
  if (!encoder || !WebPAnimEncoderAdd(encoder.get(), nullptr, milliseconds(count), nullptr) ||
      !WebPAnimEncoderAssemble(encoder.get(), &data))
    fail("libwebp has no memory for it");
  out.write(reinterpret_cast<const char*>(data.bytes), static_cast<std::streamsize>(data.size));
  WebPDataClear(&data);
}

void write_mp4(const std::string& path, int count, double frame_rate, const Sequence& picture) {
  if (count < 1) fail("it has no pictures");
  const std::string temporary = path + "." + std::to_string(::getpid()) + ".tmp";
  // Declared before ffmpeg, which writes it: so it is removed after ffmpeg has ended.
  geo::TemporaryOutput unfinished(temporary);
  // pad: yuv420p needs even sizes. crf: 0 to 51, x264's default is 23; lower: better pictures,
  // larger files. One thread and bitexact: the same pictures give the same bytes.
  std::unique_ptr<PipedProgram> ffmpeg;
  for (int i = 0; i < count; ++i) {
    const Picture shown = picture(i);
    if (!ffmpeg)
      ffmpeg = std::make_unique<PipedProgram>(
          std::vector<std::string>{"ffmpeg",    "-loglevel",
                                   "error",     "-y",
                                   "-f",        "rawvideo",
                                   "-pix_fmt",  "rgb24",
                                   "-s",        std::to_string(shown.width) + "x" + std::to_string(shown.height),
                                   "-r",        std::to_string(frame_rate),
                                   "-i",        "-",
                                   "-vf",       "pad=ceil(iw/2)*2:ceil(ih/2)*2",
                                   "-c:v",      "libx264",
                                   "-threads",  "1",
                                   "-crf",      "20",
                                   "-pix_fmt",  "yuv420p",
                                   "-fflags",   "+bitexact",
                                   "-flags:v",  "+bitexact",
                                   "-movflags", "+faststart",
                                   "-f",        "mp4",
                                   temporary});
    ffmpeg->put(rgb_bytes(shown));
  }
  if (!ffmpeg || ffmpeg->end() != 0) fail("ffmpeg failed");
  unfinished.commit(path);
}

}  // namespace view
