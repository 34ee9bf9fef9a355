// One message of each kind that a page sends, and random damage to them.
#pragma once

#include <cstddef>
#include <random>
#include <string>
#include <vector>

inline std::vector<std::string> sample_messages() {
  return {
      R"({"ack":4294967295})",
      R"({"want":{"nodes":true,"stress":false,"graph":true}})",
      R"({"knife":{"id":3,"phase":"begin","input":17,"eye":[0.5,-6,1e-3],"ray":[0,2,0],"depth":12.5,"from":0.25}})",
      R"({"scalpel":{"id":4,"phase":"move","input":18,"point":[0,0,1],"normal":[0,0,1],"depth":0.4}})",
      R"({"grab":{"id":5,"phase":"begin","input":19,"face":12,"bary":[0.2,0.3,0.5],"to":[1,2,3]}})",
      R"({"grab":{"id":5,"phase":"end","input":20,"to":[1,2,3]}})",
      R"({"pin":{"face":12,"bary":[1,0,0],"on":true,"radius":0.3}})",
      R"({"set":{"young":1e5,"gravity":[0,0,-9.81],"friction":0.5,"damping":1}})",
      R"({"undo":true})",
      R"({"reset":true})",
      R"({"pause":false})",
      R"({"step":true})",
      R"({"knife":{"id":3,"phase":"move","input":21,"eye":[0,-6,0],"ray":[0,1,0],"depth":9,"from":1,)"
      R"("way":[[0,2,0,3],[1,0,0,0.5]]}})",
      R"({"scalpel":{"id":4,"phase":"end","input":22,"point":[0,0,1],"normal":[0,0,1],"depth":0.4,)"
      R"("way":[[1,0,1,0,0,2]]}})",
      R"({"grab":{"id":6,"phase":"begin","input":23,"held":2,"to":[1,2,3]}})",
      R"({"grab":{"id":6,"phase":"hold","input":24,"held":2,"to":[1,2,3]}})",
      R"({"redo":true})",
      R"({"show":"apple"})",
      R"({"want":{"rest":true}})",
      R"({"break":{"face":12,"bary":[0.5,0.25,0.25],"cells":9}})",
      R"({"set":{"tension":1.3,"resistance":2000,"dullness":0.5}})",
  };
}

/// A sample with bytes changed, doubled, left out, or exchanged with those of another sample.
inline std::string damaged_message(const std::vector<std::string>& samples, std::mt19937_64& random) {
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  std::string text = samples[below(samples.size())];
  for (std::size_t k = below(4) + 1; k > 0; --k) {
    const std::size_t at = below(text.size() + 1), n = below(12);
    const std::string& other = samples[below(samples.size())];
    switch (below(7)) {
      case 0:
        if (at < text.size()) text[at] = static_cast<char>(random());
        break;
      case 1:
        text.insert(at, text.substr(at, n));
        break;
      case 2:
        text.erase(at, n);
        break;
      case 3:
        text.insert(at, other.substr(below(other.size()), n));
        break;
      case 4:
        text.insert(at, std::string(below(600), "[{\"9e-,"[below(7)]));
        break;
      case 5:
        text.insert(at, std::to_string(random()));
        break;
      default:
        text = text.substr(0, at) + other.substr(below(other.size()));
        break;
    }
  }
  return text;
}
