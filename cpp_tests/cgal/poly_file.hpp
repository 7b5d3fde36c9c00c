// Reads what the cross-check needs of a TetGen .poly file: points and facets of one polygon each.
#ifndef WELLSPACED_TESTS_POLY_FILE_HPP
#define WELLSPACED_TESTS_POLY_FILE_HPP

#include <cstddef>
#include <cstdint>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace poly_file {

struct Poly {
  std::vector<double> xyz;
  std::vector<std::vector<std::uint32_t>> facets;
};

// The numbers of the next line that has any.
class Lines {
 public:
  explicit Lines(const std::string& path) : in_(path), path_(path) {
    if (!in_) throw std::runtime_error("cannot open " + path);
  }
  std::vector<double> next() {
    for (std::string line; std::getline(in_, line);) {
      std::istringstream fields(line.substr(0, line.find('#')));
      std::vector<double> numbers;
      for (std::string field; fields >> field;) numbers.push_back(std::stod(field));
      if (!numbers.empty()) return numbers;
    }
    throw std::runtime_error(path_ + " ends too early");
  }

 private:
  std::ifstream in_;
  std::string path_;
};

inline Poly read(const std::string& path) {
  Lines lines(path);
  Poly poly;
  const auto count = static_cast<std::size_t>(lines.next().at(0));
  double first = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const auto row = lines.next();
    if (i == 0) first = row.at(0);
    poly.xyz.insert(poly.xyz.end(), {row.at(1), row.at(2), row.at(3)});
  }
  const auto facets = static_cast<std::size_t>(lines.next().at(0));
  for (std::size_t i = 0; i < facets; ++i) {
    if (lines.next().at(0) != 1) throw std::runtime_error(path + ": a facet of several polygons");
    const auto row = lines.next();
    std::vector<std::uint32_t> polygon;
    for (std::size_t k = 1; k <= static_cast<std::size_t>(row.at(0)); ++k)
      polygon.push_back(static_cast<std::uint32_t>(row.at(k) - first));
    poly.facets.push_back(polygon);
  }
  return poly;
}

}  // namespace poly_file

#endif
