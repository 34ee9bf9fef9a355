#include <cstdio>
#include <iostream>

#include "bench.h"

namespace bench {

void print(const Figures& figures, bool json) {
  if (!json) {
    for (const auto& [key, value] : figures) std::printf("%-34s %.4g\n", key.c_str(), value);
    return;
  }
  std::cout << '{';
  bool first = true;
  for (const auto& [key, value] : figures) std::cout << (first ? "" : ",") << '"' << key << "\":" << value, first = false;
  std::cout << "}\n";
}

}  // namespace bench
