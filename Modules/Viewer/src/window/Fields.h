// SPDX-FileCopyrightText: The Explica developers
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <QDoubleSpinBox>
#include <QString>

namespace explica::viewer {

/// Gives a field the name by which scripts set it, and what it says under the pointer.
template <class Field>
Field* named(Field* field, const QString& name, const char* tip) {
  field->setObjectName(name);
  field->setToolTip(tip);
  return field;
}

/// A field for a number within bounds.
struct NumberBounds {
  double low = 0;
  double high = 1;
  double step = 0.1;
  int decimals = 3;
  const char* unit = "";
};
inline QDoubleSpinBox* numberField(const QString& name, const char* tip,
                                   const NumberBounds& bounds) {
  auto* box = named(new QDoubleSpinBox, name, tip);
  box->setRange(bounds.low, bounds.high);
  box->setSingleStep(bounds.step);
  box->setDecimals(bounds.decimals);
  box->setSuffix(bounds.unit);
  box->setKeyboardTracking(false);
  box->setFocusPolicy(Qt::ClickFocus);
  return box;
}

}  // namespace explica::viewer
