#include <algorithm>
#include <cmath>
#include <deque>
#include <set>

#include "core/board/detect/lattice.h"

namespace ca2 {
namespace {

Cell operator-(const Cell& a) {
  return {-a.first, -a.second};
}

const Cell axes[] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};

const Node* node_at(const Lattice& lattice, const Cell& cell) {
  const auto it = lattice.find(cell);
  return it == lattice.end() ? nullptr : &it->second;
}

/// The slots of the neighbour reached from `from` by `slot`, which it sees in its own slot `back`: opposite
/// along the edge, and the bright side is the same.
std::array<Cell, 4> steps_of_neighbour(const Node& from, int slot, int back) {
  std::array<Cell, 4> step;
  const auto set = [&](int k, const Cell& cell) {
    step[static_cast<std::size_t>(k)] = cell;
    step[static_cast<std::size_t>((k + 2) % 4)] = -cell;
  };
  set(back, -from.step[static_cast<std::size_t>(slot)]);
  set(bright_slot(back), from.step[static_cast<std::size_t>(bright_slot(slot))]);
  return step;
}

/// Where the neighbours of an empty cell expect its corner: every straight continuation and every
/// parallelogram has a voice.
struct Prediction {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double pitch = 1e9;  ///< px, the shorter side of the squares here
};

std::optional<Prediction> predict(const Lattice& lattice, const Cell& cell, const Lines& lines) {
  Prediction result;
  double weight = 0;
  const auto vote = [&](double w, const Eigen::Vector2d& pixel, double side) {
    result.pixel += w * pixel;
    weight += w;
    result.pitch = std::min(result.pitch, side);
  };
  const auto pixel = [&](const Cell& c) -> const Eigen::Vector2d* {
    const Node* node = node_at(lattice, c);
    return node != nullptr ? &node->saddle.pixel : nullptr;
  };
  const auto distance = [&](const Cell& to) { return (lines.place(to) - lines.place(cell)).sum(); };
  for (int k = 0; k < 4; ++k) {
    const Cell& axis = axes[k];
    const Cell& next = axes[(k + 1) % 4];
    const Eigen::Vector2d* one = pixel(cell + axis);
    if (one == nullptr) continue;
    const double a = distance(cell + axis);
    const Eigen::Vector2d* two = pixel(cell + axis + axis);
    if (two != nullptr) {
      // Through the corners as a line and as a parabola goes.
      const double b = distance(cell + axis + axis);
      const Eigen::Vector2d slope = (*two - *one) / (b - a);
      const Eigen::Vector2d* three = pixel(cell + axis + axis + axis);
      const double side = std::abs(a) * slope.norm();
      if (three != nullptr) {
        const double c = distance(cell + axis + axis + axis);
        const Eigen::Vector2d bend = ((*three - *two) / (c - b) - slope) / (c - a);
        vote(2, *one - a * slope + a * b * bend, side);
      } else {
        vote(1, *one - a * slope, side);
      }
    }
    if (k < 2) {
      const Eigen::Vector2d* behind = pixel(cell + -axis);
      if (behind != nullptr) {
        const double b = distance(cell + -axis);
        const Eigen::Vector2d slope = (*behind - *one) / (b - a);
        vote(4, *one - a * slope, std::min(std::abs(a), std::abs(b)) * slope.norm());
      }
    }
    const Eigen::Vector2d* side = pixel(cell + next);
    const Eigen::Vector2d* corner = pixel(cell + axis + next);
    if (side != nullptr && corner != nullptr) {
      vote(1, *one + *side - *corner, std::min((*one - *corner).norm(), (*side - *corner).norm()));
    }
  }
  if (weight == 0) return std::nullopt;
  result.pixel /= weight;
  return result;
}

/// The corner at an empty cell, if the picture has one there that fits all its neighbours.
std::optional<Node> find_corner(const std::vector<SaddleLevel>& levels, const Lattice& lattice,
                                const Cell& cell, const Squares& squares, const Lines& lines) {
  const auto prediction = predict(lattice, cell, lines);
  if (!prediction) return std::nullopt;
  int level = 0;
  double strength = 0;
  int neighbours = 0;
  for (const Cell& axis : axes) {
    const Node* node = node_at(lattice, cell + axis);
    if (node == nullptr) continue;
    level = std::max(level, node->saddle.level);
    strength += node->saddle.strength;
    ++neighbours;
  }
  const auto saddle = saddle_near(levels, level, prediction->pixel, squares.rings);
  if (!saddle || saddle->strength < 0.3 * strength / neighbours) return std::nullopt;
  if ((saddle->pixel - prediction->pixel).norm() > std::max(0.25 * prediction->pitch, 1.0)) {
    return std::nullopt;
  }
  std::optional<Node> found;
  for (const Cell& axis : axes) {
    const Node* node = node_at(lattice, cell + axis);
    if (node == nullptr) continue;
    const auto towards = std::find(node->step.begin(), node->step.end(), -axis);
    const int slot = static_cast<int>(towards - node->step.begin());
    if (!edge_between(levels, node->saddle, slot, *saddle, squares)) return std::nullopt;
    // The slot of the new corner that leads back.
    int back = 0;
    for (int k = 1; k < 4; ++k) {
      const Eigen::Vector2d home = node->saddle.pixel - saddle->pixel;
      if (slot_direction(*saddle, k).dot(home) > slot_direction(*saddle, back).dot(home)) back = k;
    }
    const Node candidate{*saddle, steps_of_neighbour(*node, slot, back)};
    if (found && found->step != candidate.step) return std::nullopt;
    found = candidate;
  }
  return found;
}

}  // namespace

std::vector<Lattice> connected_lattices(const std::vector<Saddle>& saddles,
                                        const std::vector<std::array<int, 4>>& links, std::size_t least,
                                        std::size_t most) {
  std::vector<Lattice> lattices;
  std::vector<bool> used(saddles.size(), false);
  for (std::size_t seed = 0; seed < saddles.size(); ++seed) {
    if (used[seed]) continue;
    used[seed] = true;
    Lattice lattice;
    lattice[{0, 0}] = {saddles[seed], {axes[0], axes[1], axes[2], axes[3]}};
    std::deque<std::pair<std::size_t, Cell>> queue{{seed, {0, 0}}};
    while (!queue.empty()) {
      const auto [index, cell] = queue.front();
      queue.pop_front();
      const Node node = lattice.at(cell);
      for (int slot = 0; slot < 4; ++slot) {
        const int other = links[index][static_cast<std::size_t>(slot)];
        if (other < 0 || used[static_cast<std::size_t>(other)]) continue;
        const Cell there = cell + node.step[static_cast<std::size_t>(slot)];
        if (lattice.count(there) != 0) continue;
        const auto& back_links = links[static_cast<std::size_t>(other)];
        const auto back = std::find(back_links.begin(), back_links.end(), static_cast<int>(index));
        const int back_slot = static_cast<int>(back - back_links.begin());
        lattice[there] = {saddles[static_cast<std::size_t>(other)],
                          steps_of_neighbour(node, slot, back_slot)};
        used[static_cast<std::size_t>(other)] = true;
        queue.emplace_back(static_cast<std::size_t>(other), there);
      }
    }
    if (lattice.size() >= least) lattices.push_back(std::move(lattice));
  }
  std::stable_sort(lattices.begin(), lattices.end(),
                   [](const Lattice& a, const Lattice& b) { return a.size() > b.size(); });
  if (lattices.size() > most) lattices.resize(most);
  return lattices;
}

void grow(const std::vector<SaddleLevel>& levels, Lattice& lattice, std::size_t most, const Squares& squares,
          const Lines& lines) {
  for (bool added = true; added && lattice.size() <= most;) {
    added = false;
    std::set<Cell> frontier;
    for (const auto& [cell, node] : lattice) {
      for (const Cell& axis : axes) {
        if (lattice.count(cell + axis) == 0) frontier.insert(cell + axis);
      }
    }
    for (const Cell& cell : frontier) {
      if (lattice.size() > most) break;
      if (const auto node = find_corner(levels, lattice, cell, squares, lines)) {
        lattice[cell] = *node;
        added = true;
      }
    }
  }
}

}  // namespace ca2
