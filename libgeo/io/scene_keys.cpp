// Overrides of keys by dotted names, and motions from tables.
#include <algorithm>
#include <charconv>

#include "io/line_reader.h"
#include "io/scene_keys.h"
#include "kerf/files.h"

namespace geo {
namespace {

std::size_t index_of(const std::string& part, std::size_t size, const std::string& key) {
  std::size_t i = 0;
  const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), i);
  if (error != std::errc() || end != part.data() + part.size())
    throw InputError("--set " + shown(key) + ": '" + shown(part) + "' names no row of a list; give its number, from 0");
  if (i >= size)
    throw InputError("--set " + shown(key) + ": there is no row " + std::to_string(i) + ", there are " +
                     std::to_string(size));
  return i;
}

}  // namespace

void override_key(toml::table& root, const std::string& key, const std::string& value) {
  toml::table parsed;
  try {
    parsed = toml::parse("value = " + value);
  } catch (const toml::parse_error&) {
    parsed = toml::table{{"value", value}};  // a word without quotes is text
  }
  toml::node* at = &root;
  for (std::size_t from = 0; from <= key.size();) {
    const std::size_t dot = std::min(key.find('.', from), key.size());
    const std::string part = key.substr(from, dot - from);
    const bool last = dot == key.size();
    from = dot + 1;
    if (toml::table* table = at->as_table()) {
      if (last) {
        const std::initializer_list<const char*> fineness{"spacing", "spacing_percent",
                                                          "nodes"};  // a body has one of them: the override
        if (std::find(fineness.begin(), fineness.end(), part) != fineness.end())
          for (const char* other : fineness) table->erase(other);
        table->insert_or_assign(part, *parsed.get("value"));
        return;
      }
      if (!table->contains(part)) table->insert(part, toml::table{});
      at = table->get(part);
    } else if (toml::array* array = at->as_array()) {
      const std::size_t i = index_of(part, array->size(), key);
      if (last) {
        array->replace(array->cbegin() + static_cast<std::ptrdiff_t>(i), *parsed.get("value"));
        return;
      }
      at = array->get(i);
    } else {
      throw InputError("--set " + shown(key) + ": '" + shown(part) +
                       "' is asked of what is neither a table nor a list");
    }
  }
}

std::vector<Motion::Key> parse_motion(const std::string& text, const std::string& name) {
  std::string blanks = text;
  std::replace_if(
      blanks.begin(), blanks.end(), [](char c) { return c == ',' || c == ';'; }, ' ');
  LineReader lines(blanks, name);
  std::vector<Motion::Key> keys;
  std::vector<std::string_view> words;
  for (bool first = true; lines.next(words); first = false) {
    if (first && (words[0][0] == 't' || words[0][0] == 'T' || words[0][0] == '"')) continue;
    if (words.size() != 8)
      lines.fail("has " + std::to_string(words.size()) + " numbers; a line is: time, x, y, z, ax, ay, az, degrees");
    double v[8];
    for (int i = 0; i < 8; ++i) v[i] = lines.real(words[static_cast<std::size_t>(i)]);
    keys.push_back({.time = v[0], .position = {v[1], v[2], v[3]}, .axis = {v[4], v[5], v[6]}, .angle = v[7]});
    if (const auto wrong = unfit(keys); !wrong.empty()) lines.fail(wrong);
  }
  return keys;
}

std::string unfit(const std::vector<Motion::Key>& keys) {
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (!(keys[i].axis.norm() > 0)) return "a key has no axis: write 0, 0, 1, 0 for no rotation";
    if (i > 0 && !(keys[i].time > keys[i - 1].time)) return "keys must ascend in time";
  }
  return {};
}

}  // namespace geo
