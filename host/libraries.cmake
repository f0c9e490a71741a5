# The libraries and what each may use: the picture of the architecture. A folder is a library, a library is one target,
# and a target sees the headers of the libraries in its row alone, so an include across this table does not compile.
# scripts/check_layers.py, a test, holds the includes of all files against it.
#
#            folder                   may use
pvg_library(host/base                                                                                          )
pvg_library(host/device               base                                                                     )
pvg_library(host/geometry             base                                                                     )
pvg_library(host/pictures             base                                                                     )
pvg_library(host/model                base geometry pictures                                                   )
pvg_library(host/physics/linear       base device geometry                                                     )
pvg_library(host/physics/contact      base device geometry model physics/linear                                )
pvg_library(host/physics/energies     base device geometry model physics/linear physics/contact                )
pvg_library(host/physics/step         base device geometry model physics/linear physics/contact physics/energies)
pvg_library(host/render               base device geometry pictures model                                      )
if(PVG_IO)
  pvg_library(host/formats            base geometry pictures                                                   )
  pvg_library(host/robot              base geometry pictures model formats                                     )
  pvg_library(host/load/fields        base geometry pictures model                                             )
  pvg_library(host/load               base geometry pictures model formats robot load/fields                   )
  pvg_library(host/load/recording     base geometry pictures model formats robot load/fields load              )
  pvg_library(host/capture            base device geometry pictures model render formats robot load/fields load)
  pvg_library(host/capture/objects    base device geometry pictures model render formats load capture          )
  pvg_library(host/calibration        base geometry pictures model                                             )
  pvg_library(host/dataset            base geometry pictures model formats robot load/fields load              )
  set(PHYSICS physics/linear physics/contact physics/energies physics/step)
  pvg_library(host/identify           base                                                                     )
  set(IDENTIFY base device geometry pictures model ${PHYSICS} render formats robot load/fields load load/recording
      dataset identify)
  pvg_library(host/identify/channels   ${IDENTIFY}                                                             )
  set(MEASURED ${IDENTIFY} identify/channels)
  pvg_library(host/identify/data       ${MEASURED}                                                             )
  pvg_library(host/identify/sensing    ${MEASURED} identify/data                                               )
  pvg_library(host/identify/candidates ${MEASURED} identify/data identify/sensing                              )
  pvg_library(host/identify/fit        ${MEASURED} identify/data identify/sensing identify/candidates          )
  pvg_library(host/identify/search     ${MEASURED} identify/data identify/sensing identify/candidates identify/fit)
  pvg_library(host/identify/report     ${MEASURED} identify/data identify/sensing identify/candidates identify/fit
                                       identify/search                                                         )
  pvg_library(pipeline/graph           base                                                                    )
  set(EPISODE base device geometry pictures model ${PHYSICS} render formats robot load/fields load dataset graph)
  pvg_library(pipeline/episode         ${EPISODE}                                                              )
  pvg_library(pipeline/serve           ${EPISODE} episode                                                      )
  pvg_library(pipeline/validation      ${EPISODE} episode identify/report                                      )
  pvg_library(pipeline/bench           ${EPISODE} episode                                                      )
  pvg_library(pipeline/command_line    base                                                                    )
  pvg_library(pipeline/commands        ${EPISODE} load/recording episode serve capture capture/objects calibration
                                       validation bench command_line identify identify/channels identify/data identify/sensing
                                       identify/candidates identify/fit identify/search identify/report        )
endif()
