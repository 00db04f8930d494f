#pragma once

#include <deque>

namespace batten {

/// The non-monotone search of [GrippoLamparielloLucidi1986] along the gradient r of a quadratic
/// functional Phi: a step need only bring it below the largest of its last values.
class NonmonotoneSearch {
  public:
    /// Over so many last values, 1 or more.
    explicit NonmonotoneSearch(int memory) : memory_(memory) {}

    int memory() const { return memory_; }
    /// How often steps were halved so far.
    int halvings() const { return halvings_; }
    void start();
    /// The step, halved until Phi is enough below; `rho` is <r, r>, `curvature` <r, H r>.
    double searched(double step, double rho, double curvature);
    /// After a move that changed Phi by so much.
    void moved(double change);

  private:
    int memory_;
    double functional_ = 0;          ///< Phi less that of the start
    std::deque<double> functionals_; ///< the last ones
    int halvings_ = 0;
};

} // namespace batten
