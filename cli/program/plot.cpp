// SPDX-License-Identifier: BSD-3-Clause
#include "program/plot.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "program/child_process.h"
#include "program/exit_codes.h"
#include "program/numbers.h"
#include "program/page.h"

namespace sfdae::cli {

namespace {

constexpr std::size_t max_curves = 12;  // per panel: more are indistinguishable

// The curves of a panel, columns of the trajectory.
struct Panel {
  std::string unit;
  std::vector<std::size_t> columns;
};

std::vector<Panel> panels_of(const Trajectory& trajectory) {
  std::vector<Panel> panels;
  for (std::size_t j = 0; j < trajectory.names.size(); ++j) {
    const std::string& unit = trajectory.units[j];
    auto panel = std::find_if(panels.begin(), panels.end(),
                              [&unit](const Panel& candidate) { return candidate.unit == unit; });
    if (panel == panels.end()) panel = panels.insert(panels.end(), Panel{unit, {}});
    panel->columns.push_back(j);
  }
  return panels;
}

// Shortened to fit next to others.
std::string shortened(const std::string& name) {
  constexpr std::size_t max_length = 48;
  if (name.size() <= max_length) return name;
  return name.substr(0, max_length / 2) + "..." + name.substr(name.size() - max_length / 2);
}

// A gnuplot string: only quotes are special within single quotes.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += c == '\n' || c == '\r' ? ' ' : c;
  }
  return result + "'";
}

std::string terminal_for(const std::string& path, std::size_t num_panels) {
  const std::string ending = std::filesystem::path(path).extension().string();
  const std::size_t height = num_panels == 1 ? 480 : 100 + 260 * num_panels;
  if (ending == ".pdf")
    return "pdfcairo noenhanced size 10in," + full_text(static_cast<double>(height) / 96.0) + "in";
  const std::string size = " noenhanced background '#ffffff' size 1000," + std::to_string(height);
  return (ending == ".svg" ? "svg" : "pngcairo") + size;
}

std::string data_block(const Trajectory& trajectory, const std::vector<Panel>& panels) {
  std::string text = "$data << END_OF_DATA\n";
  for (std::size_t k = 0; k < trajectory.t.size(); ++k) {
    text += full_text(trajectory.t[k]);
    for (const Panel& panel : panels)
      for (const std::size_t j : panel.columns)
        text += " " + full_text(trajectory.values[k * trajectory.names.size() + j]);
    text += "\n";
  }
  return text + "END_OF_DATA\n";
}

// Definitions that plot.gp needs.
std::string definitions(const Trajectory& trajectory, const std::vector<Panel>& panels) {
  std::string titles, units, firsts, lasts;
  std::size_t column = 2;
  for (const Panel& panel : panels) {
    units += (units.empty() ? "" : ",") + quoted(panel.unit.empty() ? "1" : panel.unit);
    firsts += (firsts.empty() ? "" : ",") + std::to_string(column);
    for (const std::size_t j : panel.columns)
      titles += (titles.empty() ? "" : ",") + quoted(shortened(trajectory.names[j]));
    column += panel.columns.size();
    lasts += (lasts.empty() ? "" : ",") + std::to_string(column - 1);
  }
  const std::string count = "[" + std::to_string(panels.size()) + "] = [";
  return "array title[" + std::to_string(column - 2) + "] = [" + titles + "]\narray unit" + count + units +
         "]\narray first" + count + firsts + "]\narray last" + count + lasts + "]\n";
}

// A temporary file, closed and removed in the destructor.
class TemporaryFile {
 public:
  TemporaryFile() : descriptor_(::mkostemp(path_.data(), O_CLOEXEC)) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    ::unlink(path_.c_str());
  }
  bool is_open() const { return descriptor_ >= 0; }
  const std::string& path() const { return path_; }
  bool write(const std::string& text) {
    return ::pwrite(descriptor_, text.data(), text.size(), 0) == static_cast<ssize_t>(text.size());
  }
  std::string first_lines() const {
    char text[400];
    const ssize_t count = ::pread(descriptor_, text, sizeof text, 0);
    return {text, static_cast<std::size_t>(std::max<ssize_t>(count, 0))};
  }

 private:
  std::string path_ = (std::filesystem::temp_directory_path() / "sfdae-XXXXXX").string();
  int descriptor_;
};

}  // namespace

void require_plotter(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending != ".svg" && ending != ".png" && ending != ".pdf")
    throw ProgramError(wrong_use, "--plot " + path + ": the file has to end in .svg, .png or .pdf");
  if (find_program("gnuplot").empty())
    throw ProgramError(
        not_written,
        "--plot needs gnuplot, which is not installed (Debian, Ubuntu: apt install gnuplot-nox); --html "
        "draws without it");
}

std::string draw_plot(const Trajectory& trajectory, const std::string& title, OutputFile& file) {
  if (trajectory.names.empty()) throw ProgramError(wrong_use, "--plot: there are no variables to draw");
  std::vector<Panel> panels = panels_of(trajectory);
  std::string warning;
  for (Panel& panel : panels) {
    if (panel.columns.size() <= max_curves) continue;
    warning = "--plot shows " + std::to_string(max_curves) + " of " + std::to_string(panel.columns.size()) +
              " curves with unit '" + panel.unit + "'; --variables chooses";
    panel.columns.resize(max_curves);
  }
  TemporaryFile script, errors;
  const std::string output = file.temporary_path().empty() ? file.path() : file.temporary_path();
  const std::string text = data_block(trajectory, panels) + definitions(trajectory, panels) +
                           "model = " + quoted(title) + "\nset terminal " + terminal_for(file.path(), panels.size()) +
                           "\nset output " + quoted(output) + "\n" + plot_script;
  if (!script.is_open() || !errors.is_open() || !script.write(text))
    throw ProgramError(not_written, std::string("--plot: cannot write temporary files: ") + std::strerror(errno));
  if (run_program(find_program("gnuplot"), {script.path()}, errors.path()) != 0)
    throw ProgramError(not_written, "--plot " + file.path() + ": gnuplot failed: " + errors.first_lines());
  file.commit();
  return warning;
}

}  // namespace sfdae::cli
