// Fractures of several shards of a model are made in parallel, one on a thread. Shards are written
// in order.
#include "dataset/run.h"

#include <unistd.h>

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <mutex>

#include <kerf/error.h>
#include <kerf/files.h>
#include <kerf/parallel.h>
#include "dataset/index.h"
#include "dataset/shard_file.h"

namespace dataset {
namespace {

namespace fs = std::filesystem;

double cpu_now() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

// As many shards at once as have this many fractures: enough for many threads, few enough for
// memory.
constexpr int batch_fractures = 100;

class Making {
 public:
  Making(const std::string& folder, const std::vector<ModelFile>& models, const Settings& settings,
         const std::vector<Shard>& shards, const geo::Progress& progress)
      : folder_(folder), models_(models), settings_(settings), shards_(shards), progress_(progress) {}

  Totals run(std::pair<std::size_t, std::size_t> part) {
    std::vector<std::size_t> missing;
    for (auto row = part.first; row < part.second; ++row) {
      const auto count = static_cast<std::size_t>(shards_[row].count);
      if (fs::exists(at(shards_[row].record)))
        totals_.found += count;
      else {
        missing.push_back(row);
        total_ += count;
      }
    }
    for (std::size_t begin = 0; begin < missing.size();) {
      std::size_t end = begin;
      while (end < missing.size() && shards_[missing[end]].model == shards_[missing[begin]].model) ++end;
      make_model({missing.begin() + std::ptrdiff_t(begin), missing.begin() + std::ptrdiff_t(end)});
      begin = end;
    }
    geo::report(progress_, "done", total_, total_);
    return totals_;
  }

 private:
  std::string at(const std::string& path) const { return folder_ + "/" + path; }
  std::string unfinished(std::size_t row) const {
    return at("unfinished/" + std::to_string(row) + "." + std::to_string(::getpid()));
  }

  // Makes the missing shards of one model.
  void make_model(const std::vector<std::size_t>& rows) {
    const ModelFile& file = models_[shards_[rows.front()].model];
    Model model;
    std::string refused;
    try {
      model = read_model(file.path, file.name, settings_.repair,
                         [&](const std::string& line) { totals_.notes.push_back(line); });
    } catch (const geo::MissingInputError&) {
      throw;  // it may be there tomorrow
    } catch (const std::runtime_error& e) {
      refused = e.what();
      if (refused.starts_with(file.path + ": ")) refused.erase(0, file.path.size() + 2);
      ++totals_.refused_models;
    }
    if (refused.empty()) write_intact_model(model, rows.front());
    for (std::size_t begin = 0; begin < rows.size();) {
      std::size_t end = begin;
      int fractures = 0;
      while (end < rows.size() && (end == begin || fractures + shards_[rows[end]].count <= batch_fractures))
        fractures += shards_[rows[end++]].count;
      make_batch(model, refused, {rows.begin() + std::ptrdiff_t(begin), rows.begin() + std::ptrdiff_t(end)});
      begin = end;
    }
  }

  // Before the first shard of it: what is in a shard has its model.
  void write_intact_model(const Model& model, std::size_t row) {
    const std::string path = intact_path(models_[shards_[row].model], settings_);
    if (fs::exists(at(path))) return;
    fs::create_directories(fs::path(at(path)).parent_path());
    geo::TemporaryOutput output(unfinished(row));
    geo::write_all(unfinished(row), [&](std::ostream& out) { write_intact(out, model); });
    put(output, path);
  }

  void make_batch(const Model& model, const std::string& refused, const std::vector<std::size_t>& rows) {
    std::vector<std::vector<Outcome>> outcomes(rows.size());
    std::vector<std::pair<std::size_t, std::size_t>> jobs;  // row in `rows`, fracture
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const Shard& shard = shards_[rows[i]];
      outcomes[i].resize(static_cast<std::size_t>(shard.count));
      for (std::size_t k = 0; k < outcomes[i].size(); ++k) {
        outcomes[i][k].seed = shard.first_seed + k;
        outcomes[i][k].why = refused;
        jobs.push_back({i, k});
      }
    }
    if (refused.empty())
      geo::parallel_for(jobs.size(), 1, [&](std::size_t begin, std::size_t end) {
        const geo::SerialScope serial;
        for (auto j = begin; j < end; ++j) {
          make_one(model, shards_[rows[jobs[j].first]].pattern, outcomes[jobs[j].first][jobs[j].second]);
          const std::lock_guard lock(mutex_);
          geo::report(progress_, model.name, ++done_, total_);
        }
      });
    for (std::size_t i = 0; i < rows.size(); ++i) write(rows[i], outcomes[i], refused);
  }

  void make_one(const Model& model, geo::Pattern pattern, Outcome& outcome) const {
    try {
      outcome.fracture = break_model(model, recipe_of(settings_, pattern, outcome.seed));
      if (settings_.rotate) pose(*outcome.fracture);
    } catch (const geo::GeometryError& e) {
      outcome.why = e.what();
    } catch (const geo::InputError& e) {
      outcome.why = e.what();
    }
  }

  void write(std::size_t row, const std::vector<Outcome>& outcomes, const std::string& refused) {
    const Shard& shard = shards_[row];
    const ModelFile& file = models_[shard.model];
    fs::create_directories(fs::path(at(shard.data)).parent_path());
    geo::TemporaryOutput data(unfinished(row));
    if (!settings_.folders) {
      geo::write_all(unfinished(row), [&](std::ostream& out) { write_archive(out, outcomes, settings_.single); });
      put(data, shard.data);
    } else if (const auto& fracture = outcomes.front().fracture) {
      fs::create_directories(unfinished(row));
      write_folder(unfinished(row), *fracture);
      fs::remove_all(at(shard.data));  // of a run that ended before its record was written
      put(data, shard.data);
    }
    const RecordOf of{.model = file.name,
                      .set = set_names[shard.set],
                      .file = intact_path(file, settings_),
                      .refused = refused,
                      .details = settings_.folders};
    geo::TemporaryOutput record(unfinished(row) + ".json");
    geo::write_all(unfinished(row) + ".json", [&](std::ostream& out) { write_record(out, shard, outcomes, of); });
    put(record, shard.record);
    for (const auto& outcome : outcomes) ++(outcome.fracture ? totals_.made : totals_.failed);
    if (!refused.empty()) done_ += outcomes.size();
  }

  // Renames an output into place and adds its size.
  void put(geo::TemporaryOutput& output, const std::string& path) {
    output.commit(at(path));
    if (!fs::is_directory(at(path)))
      totals_.bytes += fs::file_size(at(path));
    else
      for (const auto& entry : fs::directory_iterator(at(path))) totals_.bytes += entry.file_size();
  }

  const std::string& folder_;
  const std::vector<ModelFile>& models_;
  const Settings& settings_;
  const std::vector<Shard>& shards_;
  const geo::Progress& progress_;
  std::mutex mutex_;
  std::size_t done_ = 0, total_ = 0;
  Totals totals_;
};

}  // namespace

Totals run(const std::string& folder, const std::vector<ModelFile>& models, const Settings& settings,
           std::pair<std::size_t, std::size_t> part, const geo::Progress& progress) {
  geo::Stopwatch watch;
  const double cpu = cpu_now();
  try {
    begin_folder(folder, models, settings);
    const auto shards = plan(models, settings);
    Totals totals = Making(folder, models, settings, shards, progress).run(part);
    totals.complete = finish_folder(folder, models, settings, shards, totals.notes);
    totals.seconds = watch.lap();
    totals.cpu_seconds = cpu_now() - cpu;
    return totals;
  } catch (const fs::filesystem_error& e) {
    throw geo::OutputError(e.path1().string() + ": cannot be made (" + e.code().message() + ")");
  }
}

}  // namespace dataset
