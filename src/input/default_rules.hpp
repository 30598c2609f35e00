// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "input/case.hpp"
#include "input/document.hpp"

namespace slipfront::input {

/// How the default of a key follows from plate and material. For the default case's it is the member's own
/// default, to the last bit.
struct DefaultRule {
  std::string key;   ///< dotted
  std::string text;  ///< "0.05 width_m"
  std::function<Value(const Case&)> value;
};

/// In an order in which none depends on a later one.
const std::vector<DefaultRule>& default_rules();

/// Null where the default is a constant.
const DefaultRule* default_rule_of(const std::string& key);

/// Gives the keys that apply and that the document does not set what their rules say.
void set_defaults_by_rule(const Document& document, Case& config);

}  // namespace slipfront::input
